"""A robot on two driven wheels: its geometry, and the path that its wheels' angles make."""
