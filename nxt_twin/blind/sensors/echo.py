"""An ultrasonic echo, timed: emitter, wall, receiver, a threshold, a timer.

Nothing here knows of the sensor models that are fitted. The speed of sound comes from the gas law, and the
beam from a budget in decibels. The noise comes from the timer's jitter, which grows as the echo weakens.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import BoolArray, FloatArray

NO_ECHO_CM: Final = 255.0
_ADIABATIC, _GAS_J_PER_MOL_K, _AIR_KG_PER_MOL = 1.4, 8.314462, 0.0289652
_CENTIMETRE_MM = 10.0


@final
@dataclass(frozen=True)
class EchoMechanism:
    """An ultrasonic sensor as a mechanism.

    Attributes:
        temperature_c: of the air; the sensor's timer is made for 20 °C.
        jitter_us: of the timer at a strong echo (standard deviation).
        jitter_us_per_m: more of it for each metre, added as squares.
        blanked_mm: echoes from nearer come while the emitter still rings and are not heard.
        second_bounce: the share of blanked pings of which the echo's own echo is heard, at twice the distance.
        late_us: near echoes overdrive the receiver, which then answers later by this; the round trip's time.
        late_below_mm: where that ends.
        late_share: the share of near echoes to which it happens.
        margin_db: by which the echo at `best_mm`, square on, is above the threshold; None: always heard.
        best_mm: where the echo is strongest.
        contact_share: of the margin that is left at contact, where the receiver looks past the wall.
        fade_mm: distance beyond the best at which all of it would be spent.
        turning_db: by which it is weaker at 10° of incidence, growing as the square.
        truncates: whether whole centimetres are cut off rather than rounded.
    """

    temperature_c: float = 20.0
    jitter_us: float = 14.0
    jitter_us_per_m: float = 0.0
    blanked_mm: float = 0.0
    second_bounce: float = 0.0
    late_us: float = 0.0
    late_below_mm: float = 0.0
    late_share: float = 1.0
    margin_db: float | None = None
    best_mm: float = 438.0
    contact_share: float = 0.5
    fade_mm: float = 2200.0
    turning_db: float = 1.0
    truncates: bool = False
    bent_per_m: float = 0.0
    drift_mm_per_min: float = 0.0


def speed_of_sound_m_per_s(temperature_c: float) -> float:
    """Of dry air, by the gas law: √(γ·R·T/M)."""
    return float(np.sqrt(_ADIABATIC * _GAS_J_PER_MOL_K * (temperature_c + 273.15) / _AIR_KG_PER_MOL))


def readings_cm(
    echo: EchoMechanism, time_s: FloatArray, distance_mm: FloatArray, angle_deg: FloatArray, rng: Generator
) -> FloatArray:
    """The sensor's reading of each target, whole cm, 255 without echo; arrays of shape (polls,)."""
    count = distance_mm.size
    bent_mm = distance_mm * (1.0 + echo.bent_per_m * (distance_mm / 1000.0 - 0.5) * distance_mm / 1000.0)
    path_m = 2.0 * (bent_mm + echo.drift_mm_per_min * (time_s - time_s[0]) / 60.0) / 1000.0
    blanked = distance_mm < echo.blanked_mm
    bounced = blanked & (rng.random(count) < echo.second_bounce)
    flight_us = 1e6 * np.where(bounced, 2.0, 1.0) * path_m / speed_of_sound_m_per_s(echo.temperature_c)
    late = (distance_mm < echo.late_below_mm) & ~blanked & (rng.random(count) < echo.late_share)
    jitter_us = np.hypot(echo.jitter_us, echo.jitter_us_per_m * path_m / 2.0)
    timer_us = flight_us + np.where(late, echo.late_us, 0.0) + jitter_us * rng.standard_normal(count)
    told_mm = 0.5e-3 * timer_us * speed_of_sound_m_per_s(20.0)
    whole = np.floor(told_mm / _CENTIMETRE_MM + (0.0 if echo.truncates else 0.5))
    lost = (blanked & ~bounced) | ~_heard(echo, distance_mm, angle_deg, rng)
    return np.where(lost, NO_ECHO_CM, np.clip(whole, 0.0, NO_ECHO_CM))


def _heard(echo: EchoMechanism, distance_mm: FloatArray, angle_deg: FloatArray, rng: Generator) -> BoolArray:
    """Whether the echo is above the threshold, in decibels, with one decibel of fading."""
    if echo.margin_db is None:
        return np.ones(distance_mm.size, dtype=np.bool_)
    near = (1.0 - echo.contact_share) * np.maximum(1.0 - distance_mm / echo.best_mm, 0.0) ** 2
    far = np.maximum(distance_mm - echo.best_mm, 0.0) / echo.fade_mm
    level_db = echo.margin_db * (1.0 - near - far) - echo.turning_db * (angle_deg / 10.0) ** 2
    return np.asarray(level_db + 0.6 * rng.standard_normal(distance_mm.size) > 0.0, dtype=np.bool_)
