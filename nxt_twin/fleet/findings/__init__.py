"""Findings in a fleet's table: effects that units lack or a batch shares, drift, and units that stand out."""
