"""Effects of an ultrasonic sensor beyond reading the true distance in whole centimetres.

Source of all but the speed of sound: Gonçalves et al., section III.C.
"""

from __future__ import annotations

from nxt_twin.diagnose.sensor.declaration import SensorEffect, SensorParameter

PAPER = "Gonçalves et al. III.C"

BLIND_ZONE = SensorEffect(
    id="ultrasonic_blind_zone",
    name="blind zone",
    equation=f"no distance is measured where d < d_blind: 255, or a reading that does not follow d ({PAPER})",
    shows=("near",),
    parameters=(
        SensorParameter("blind_distance_mm", "blind_distance_mm", "mm", 3.0, 400.0, 5.0, 0.0),
        SensorParameter("silent_share", "blind_silent_share", "", 0.0, 1.0, 0.1, 1.0),
        SensorParameter("reading_mm", "blind_reading_mm", "mm", 0.0, 2550.0, 20.0, 30.0),
        SensorParameter("spread_mm", "blind_spread_mm", "mm", 2.0, 1500.0, 10.0, 10.0),
    ),
    confusable_with={
        "ultrasonic_near_offset": "several readings at each of many short distances: an offset follows the "
        "distance, a blind sensor does not",
        "ultrasonic_dropout": "short distances square on, angle 0: the beam's edge plays no part there",
    },
)

NEAR_OFFSET = SensorEffect(
    id="ultrasonic_near_offset",
    name="near offset at short range",
    equation=f"y = d + o where d < d_near, for most of the readings there ({PAPER})",
    shows=("near",),
    parameters=(
        SensorParameter("offset_mm", "near_offset_mm", "mm", -150.0, 150.0, 3.0, 0.0),
        SensorParameter("below_mm", "near_below_mm", "mm", 5.0, 1200.0, 10.0, 250.0),
        SensorParameter("share", "near_share", "", 0.5, 1.0, 0.1, 1.0),
    ),
    confusable_with={
        "ultrasonic_sound_speed": "distances far beyond the near range: a scale error keeps growing there",
        "ultrasonic_blind_zone": "several readings at each of many short distances: an offset follows the "
        "distance, a blind sensor does not",
    },
)

RANGE_NOISE = SensorEffect(
    id="ultrasonic_range_noise",
    name="range noise that grows with distance",
    equation=f"σ = σ0 + k·d, or σ² = σ0² + (k·d)² ({PAPER}: noise grows with distance; the law is ours)",
    shows=("far",),
    parameters=(SensorParameter("noise_per_distance", "noise_per_distance", "", 0.0, 0.5, 0.004, 0.0),),
    laws=({"noise_power": 1.0}, {"noise_power": 2.0}),
    confusable_with={
        "ultrasonic_dropout": "many readings at a few distances: growing noise spreads them, a lost echo is 255"
    },
)

DROPOUT = SensorEffect(
    id="ultrasonic_dropout",
    name="dropout of echoes at oblique incidence",
    equation=f"255 where |φ| > φ_max(d), widest at d_best and narrowing on both sides of it ({PAPER})",
    shows=("oblique", "no_echo"),
    parameters=(
        SensorParameter("max_angle_deg", "max_angle_deg", "deg", 3.0, 120.0, 4.0, 180.0),
        SensorParameter("best_distance_mm", "best_distance_mm", "mm", 30.0, 2400.0, 40.0, 438.0),
        SensorParameter("contact_angle_deg", "contact_angle_deg", "deg", -60.0, 120.0, 8.0, 20.0),
        SensorParameter("far_angle_deg", "far_angle_deg", "deg", -90.0, 120.0, 8.0, 15.0),
        SensorParameter("near_shape", "beam_near_shape", "", 0.4, 4.0, 0.1, 1.0),
        SensorParameter("far_shape", "beam_far_shape", "", 0.4, 4.0, 0.1, 1.0),
        SensorParameter("edge_deg", "beam_edge_deg", "deg", 0.1, 15.0, 0.7, 2.0),
    ),
    confusable_with={
        "ultrasonic_blind_zone": "short distances square on, angle 0: the beam's edge plays no part there"
    },
    stepped=True,
)

SOUND_SPEED = SensorEffect(
    id="ultrasonic_sound_speed",
    name="sound speed in air of another temperature",
    equation="y = d·c(20 °C)/c(T), c = 331.3 m/s·√(1 + T/273.15 °C), the speed of sound in dry air",
    shows=("far",),
    parameters=(SensorParameter("air_temperature_c", "air_temperature_c", "°C", -40.0, 80.0, 2.0, 20.0),),
    confusable_with={
        "ultrasonic_near_offset": "distances far beyond the near range: a scale error keeps growing there"
    },
)

EFFECTS = (BLIND_ZONE, NEAR_OFFSET, RANGE_NOISE, DROPOUT, SOUND_SPEED)
