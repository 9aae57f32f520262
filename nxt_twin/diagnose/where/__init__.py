"""When, in which regime and by which equation the baseline departs from the readings."""
