"""The missing-physics engine: re-fit, locate, explain, judge."""
