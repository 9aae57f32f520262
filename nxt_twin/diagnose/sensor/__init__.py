"""Diagnosis of sensor cases: what a sensor does beyond its ideal (docs/formats.md#sensor-cases).

Thresholds were set on seeds 100 to 106 of `python -m benchmarks.sensors` (docs/sensors.md#how-it-is-tested).
"""
