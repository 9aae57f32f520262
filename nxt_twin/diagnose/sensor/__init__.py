"""Diagnosis of sensor cases: what a sensor does beyond its ideal (docs/formats.md#sensor-cases)."""
