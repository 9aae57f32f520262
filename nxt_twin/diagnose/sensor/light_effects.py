"""Effects of a light sensor beyond a straight line along the gradient.

Source of the offset: Gonçalves et al., section III.A.
"""

from __future__ import annotations

from nxt_twin.diagnose.sensor.declaration import SensorEffect, SensorParameter

AMBIENT_OFFSET = SensorEffect(
    id="light_ambient_offset",
    name="ambient offset from room light",
    equation="y = slope·x + zero + o, another o in other room light, the slope the same (Gonçalves et al. III.A)",
    shows=("recording", "elapsed_time"),
    parameters=(SensorParameter("offset_raw", "ambient_offset_raw", "", -1023.0, 1023.0, 3.0, 0.0),),
    confusable_with={
        "light_saturation": "the whole gradient in each room light: an offset is the same everywhere on it",
    },
)

SATURATION = SensorEffect(
    id="light_saturation",
    name="saturation",
    equation="beyond the knee k the reading goes on by at most w: k ± w·(1 - exp(-|u - k|/w))",
    shows=("bright", "dark"),
    parameters=(
        SensorParameter("knee_raw", "knee_raw", "", 1.0, 1022.0, 5.0, None),
        SensorParameter("width_raw", "knee_width_raw", "", 0.5, 400.0, 10.0, 10.0),
    ),
    confusable_with={
        "light_ambient_offset": "the whole gradient in each room light: an offset is the same everywhere on it",
    },
)

FLICKER = SensorEffect(
    id="light_flicker",
    name="mains flicker",
    equation="y = slope·x + zero + A·sin(2π·f·t + φ), lamps on the mains flicker at twice its frequency",
    shows=("elapsed_time",),
    parameters=(
        SensorParameter("frequency_hz", "flicker_frequency_hz", "Hz", 3.0, 140.0, 0.005, 100.0),
        SensorParameter("amplitude_raw", "flicker_amplitude_raw", "", 0.0, 500.0, 1.0, 0.0),
    ),
    confusable_with={
        "light_ambient_offset": "the sensor at rest for some seconds: flicker comes round, room light stays",
    },
    prior_nats=10.0,
)

EFFECTS = (AMBIENT_OFFSET, SATURATION, FLICKER)
