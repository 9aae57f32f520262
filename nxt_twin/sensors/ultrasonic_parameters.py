"""The ultrasonic sensor's parameters: names, units, defaults, bounds, and how they stand in a file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, final

from nxt_twin.sensors.config import Configured, SensorLayout
from nxt_twin.sensors.fitting import Free

REFERENCE_TEMPERATURE_C = 20.0
"""Air temperature at which the sensor's own clock gives true centimetres; an assumption."""

LAYOUT = SensorLayout(
    "ultrasonic_sensor",
    {
        "ultrasonic_blind_zone": {
            "blind_distance_mm": "blind_distance_mm",
            "silent_share": "blind_silent_share",
            "reading_mm": "blind_reading_mm",
            "spread_mm": "blind_spread_mm",
        },
        "ultrasonic_near_offset": {
            "offset_mm": "near_offset_mm",
            "below_mm": "near_below_mm",
            "share": "near_share",
        },
        "ultrasonic_range_noise": {"noise_per_distance": "noise_per_distance", "power": "noise_power"},
        "ultrasonic_dropout": {
            "max_angle_deg": "max_angle_deg",
            "best_distance_mm": "best_distance_mm",
            "contact_angle_deg": "contact_angle_deg",
            "far_angle_deg": "far_angle_deg",
            "near_shape": "beam_near_shape",
            "far_shape": "beam_far_shape",
            "edge_deg": "beam_edge_deg",
        },
        "ultrasonic_sound_speed": {"air_temperature_c": "air_temperature_c"},
    },
)


@final
@dataclass(frozen=True)
class UltrasonicParameters(Configured):
    """An ultrasonic sensor. The reading's mean is scale · c(20 °C)/c(T) · distance + zero, plus the near offset.

    Attributes:
        noise_mm: standard deviation of the distance before it is rounded, mm, at distance 0.
        noise_per_distance: by how much it grows with each mm of distance.
        noise_power: how the two add: 1 as numbers, 2 as independent causes do, by their squares.
        zero_mm: the mean's shift, mm; -5 for a sensor that cuts off instead of rounding.
        scale: gain, beside what the air's temperature does.
        air_temperature_c: °C; at 20 the speed of sound is the one that the sensor assumes.
        quantum_mm: step of the reading, mm.
        transducer_spacing_mm: between the axes of emitter and receiver; lengthens short paths.
        blind_distance_mm: below it no distance is measured; 0 is off.
        blind_silent_share: probability that a blind sensor says 255; otherwise it says
        blind_reading_mm, blind_spread_mm: about this, with this standard deviation, mm.
        blind_edge_mm: width of the blind zone's edge (logistic scale), mm.
        near_offset_mm: added to the mean below `near_below_mm`; 0 is off.
        near_below_mm: where the near offset ends, mm.
        near_share: the share of near readings that have it (the paper: "most of the measurements").
        near_edge_mm: width of its end (logistic scale), mm.
        max_angle_deg: incidence at which the echo is lost at the best distance, deg; 180 is off.
        best_distance_mm: where the beam is widest, mm.
        contact_angle_deg: the limit extrapolated to distance 0, deg.
        far_angle_deg: the limit at `far_mm`, deg.
        beam_near_shape, beam_far_shape: exponents of the fall from the widest to the two: 1 is a straight line, 2 is
            rounded at the top.
        far_mm: the distance to which `far_angle_deg` belongs, mm.
        beam_edge_deg: width of the beam's edge (logistic scale), deg.
        miss_probability: of an echo lost at any distance.
        stray_probability: of a reading anywhere between 0 and 254 cm.
        crosstalk_per_mm: density of another sensor's pings, 1/mm of path; such a ping that comes before the
            echo is taken for it. One over half the way that sound makes in the other's ping period.
        update_period_s: time between pings; a poll sees the last ping's reading. 0: each poll is a ping.
    """

    layout: ClassVar[SensorLayout] = LAYOUT

    noise_mm: float = 3.0
    noise_per_distance: float = 0.0
    noise_power: float = 1.0
    zero_mm: float = 0.0
    scale: float = 1.0
    air_temperature_c: float = REFERENCE_TEMPERATURE_C
    quantum_mm: float = 10.0
    transducer_spacing_mm: float = 0.0
    blind_distance_mm: float = 0.0
    blind_silent_share: float = 1.0
    blind_reading_mm: float = 30.0
    blind_spread_mm: float = 10.0
    blind_edge_mm: float = 0.5
    near_offset_mm: float = 0.0
    near_below_mm: float = 250.0
    near_share: float = 1.0
    near_edge_mm: float = 0.5
    max_angle_deg: float = 180.0
    best_distance_mm: float = 438.0
    contact_angle_deg: float = 20.0
    far_angle_deg: float = 15.0
    far_mm: float = 1538.0
    beam_near_shape: float = 1.0
    beam_far_shape: float = 1.0
    beam_edge_deg: float = 2.0
    miss_probability: float = 0.0
    stray_probability: float = 0.0
    crosstalk_per_mm: float = 0.0
    update_period_s: float = 0.0


FREE: tuple[Free, ...] = (
    Free("noise_mm", 0.3, 200.0, 1.0),
    Free("noise_per_distance", 0.0, 0.5, 0.005),
    Free("zero_mm", -60.0, 60.0, 2.0),
    Free("scale", 0.7, 1.4, 0.01),
    Free("air_temperature_c", -40.0, 80.0, 2.0),
    Free("blind_distance_mm", 0.0, 400.0, 5.0),
    Free("blind_silent_share", 0.0, 1.0, 0.1),
    Free("blind_reading_mm", 0.0, 2550.0, 20.0),
    Free("blind_spread_mm", 1.0, 2000.0, 20.0),
    Free("near_offset_mm", -150.0, 150.0, 3.0),
    Free("near_below_mm", 0.0, 1200.0, 10.0),
    Free("near_share", 0.3, 1.0, 0.1),
    Free("max_angle_deg", 3.0, 120.0, 4.0),
    Free("best_distance_mm", 30.0, 2400.0, 40.0),
    Free("contact_angle_deg", -60.0, 120.0, 8.0),
    Free("far_angle_deg", -90.0, 120.0, 8.0),
    Free("beam_near_shape", 0.4, 4.0, 0.1),
    Free("beam_far_shape", 0.4, 4.0, 0.1),
    Free("beam_edge_deg", 0.05, 15.0, 0.7),
    Free("miss_probability", 0.0, 0.5, 0.01),
    Free("stray_probability", 0.0, 0.5, 0.01),
    Free("crosstalk_per_mm", 0.0, 2e-3, 5e-5),
)
"""The parameters that can be fitted, with their bounds."""
