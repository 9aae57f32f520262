"""Findings in a fleet's table: effects that units lack, drift, effects that a batch shares, units that stand
out."""
