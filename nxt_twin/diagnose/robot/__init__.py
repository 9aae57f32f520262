"""Find what a robot's model leaves out: wheels, track, markers, clock and slip, from wheels and an outside pose.

Thresholds of the effects that concealed robots hold were set on seeds below 1000 (docs/robots.md#concealed-robots).
"""
