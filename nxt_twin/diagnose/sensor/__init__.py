"""Diagnosis of sensor cases: what a sensor does beyond its ideal (contract 6)."""
