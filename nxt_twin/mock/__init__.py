"""A brick made of software that no client can tell from the real one: firmware, body, ways to reach it."""
