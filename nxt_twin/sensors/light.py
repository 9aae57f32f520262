"""The light sensor: a 10-bit reading along a printed gradient, with room light, saturation and mains flicker.

Source: Gonçalves et al., section III.A: room lighting adds an offset and leaves the slope unchanged. Saturation and
flicker are ours. A photodiode's room light flickers at twice the mains frequency (100 or 120 Hz).
Default parameters are the ideal sensor: a straight line and small noise.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray
from nxt_twin.sensors.config import Configured, SensorLayout
from nxt_twin.sensors.converter import HIGHEST_RAW, converted, log_probability_each
from nxt_twin.sensors.errors import SensorError
from nxt_twin.sensors.expected import Expected
from nxt_twin.sensors.fitting import FittedSensor, Free, chosen, fit_free

LAYOUT = SensorLayout(
    "light_sensor",
    {
        "light_ambient_offset": {"offset_raw": "ambient_offset_raw"},
        "light_saturation": {"knee_raw": "knee_raw", "width_raw": "knee_width_raw", "side": "knee_side"},
        "light_flicker": {
            "frequency_hz": "flicker_frequency_hz",
            "amplitude_raw": "flicker_amplitude_raw",
            "phase_rad": "flicker_phase_rad",
        },
    },
)


@final
@dataclass(frozen=True)
class LightParameters(Configured):
    """A light sensor.

    Attributes:
        slope_raw_per_mm: change of the reading along the gradient with the lamp on.
        zero_raw: the reading at position 0.
        noise_raw: standard deviation before rounding.
        unlit_slope_raw_per_mm: the same slope with the lamp off (ambient mode), by room light alone.
        lamp: 1 with the sensor's lamp on (reflected mode), 0 without (ambient mode).
        ambient_offset_raw: what the room's light adds, beside what the truth says of each poll.
        knee_raw: the level beyond which the response flattens; None is off.
        knee_width_raw: by how much the reading can still go on beyond the knee.
        knee_side: 1 if it flattens above the knee, -1 if below.
        flicker_frequency_hz, flicker_amplitude_raw, flicker_phase_rad: a sine in time; amplitude 0 is off.
    """

    layout: ClassVar[SensorLayout] = LAYOUT

    slope_raw_per_mm: float = 0.0
    zero_raw: float = 500.0
    noise_raw: float = 2.0
    unlit_slope_raw_per_mm: float = 0.0
    lamp: float = 1.0
    ambient_offset_raw: float = 0.0
    knee_raw: float | None = None
    knee_width_raw: float = 10.0
    knee_side: float = 1.0
    flicker_frequency_hz: float = 100.0
    flicker_amplitude_raw: float = 0.0
    flicker_phase_rad: float = 0.0


@final
@dataclass(frozen=True)
class LightTruth:
    """Where the sensor was at each poll; arrays of shape (polls,).

    Attributes:
        position_mm: along the gradient.
        time_s: stamps; needed only where the light flickers.
        ambient_raw: what this poll's room light adds to the reading; None is nothing.
        flicker_phase_rad: phase of the mains in this poll's run, beside the parameter; None is 0.
    """

    position_mm: FloatArray
    time_s: FloatArray | None = None
    ambient_raw: FloatArray | None = None
    flicker_phase_rad: FloatArray | None = None


FREE: tuple[Free, ...] = (
    Free("slope_raw_per_mm", -100.0, 100.0, 0.02),
    Free("zero_raw", -5000.0, 5000.0, 3.0),
    Free("noise_raw", 0.05, 300.0, 0.5),
    Free("unlit_slope_raw_per_mm", -100.0, 100.0, 0.02),
    Free("ambient_offset_raw", -1023.0, 1023.0, 3.0),
    Free("knee_raw", 0.0, 1023.0, 5.0),
    Free("knee_width_raw", 0.5, 2000.0, 10.0),
    Free("flicker_frequency_hz", 0.0, 500.0, 0.01),
    Free("flicker_amplitude_raw", 0.0, 500.0, 1.0),
    Free("flicker_phase_rad", -10.0, 10.0, 0.2),
)
"""The parameters that can be fitted, with their bounds."""


def mean_raw(parameters: LightParameters, truth: LightTruth) -> FloatArray:
    """The reading's mean before noise, rounding and the converter's ends, shape (polls,)."""
    p = parameters
    slope = p.lamp * p.slope_raw_per_mm + (1.0 - p.lamp) * p.unlit_slope_raw_per_mm
    level = p.zero_raw + p.ambient_offset_raw + slope * truth.position_mm
    if truth.ambient_raw is not None:
        level = level + truth.ambient_raw
    if p.flicker_amplitude_raw:
        if truth.time_s is None:
            mend = "give time_s, or set the flicker's amplitude to 0"
            raise SensorError("flickers, but the polls have no stamps", where="light sensor", mend=mend)
        phase = p.flicker_phase_rad + (0.0 if truth.flicker_phase_rad is None else truth.flicker_phase_rad)
        turn = 2.0 * math.pi * p.flicker_frequency_hz * truth.time_s + phase
        level = level + p.flicker_amplitude_raw * np.sin(turn)
    return flattened(parameters, level)


def flattened(parameters: LightParameters, level: FloatArray) -> FloatArray:
    """The level after saturation: k ± w·(1 - exp(-(±(u - k))/w)) beyond the knee k, w the width left."""
    knee, width, side = parameters.knee_raw, parameters.knee_width_raw, parameters.knee_side
    if knee is None:
        return level
    beyond = np.maximum(side * (level - knee), 0.0)
    return np.asarray(level - side * (beyond + width * np.expm1(-beyond / width)), dtype=np.float64)


def log_likelihood_each(parameters: LightParameters, readings: FloatArray, truth: LightTruth) -> FloatArray:
    """The logarithm of each reading's probability, nats, shape (polls,); 0 where the reading is NaN."""
    mean = mean_raw(parameters, truth)
    return log_probability_each(readings, mean, parameters.noise_raw, "light sensor")


def log_likelihood(parameters: LightParameters, readings: FloatArray, truth: LightTruth) -> float:
    """The log-likelihood of the raw readings, nats; exact for a rounded reading that stops at 0 and 1023."""
    return float(np.sum(log_likelihood_each(parameters, readings, truth)))


def simulate(parameters: LightParameters, truth: LightTruth, rng: Generator) -> FloatArray:
    """Raw readings 0 to 1023, shape (polls,), drawn from the model."""
    noise = parameters.noise_raw * rng.standard_normal(truth.position_mm.size)
    return converted(mean_raw(parameters, truth) + noise)


def expected(
    parameters: LightParameters, position_mm: float, time_s: float = 0.0, ambient_raw: float = 0.0
) -> Expected:
    """The sensor's expected reading, raw, at one place and time."""
    truth = LightTruth(np.array([position_mm]), np.array([time_s]), np.array([ambient_raw]))
    mean = float(np.clip(mean_raw(parameters, truth)[0], 0.0, HIGHEST_RAW))
    return Expected(mean, parameters.noise_raw**2 + 1.0 / 12.0, 0.0)


def fit(
    readings: FloatArray,
    truth: LightTruth,
    *,
    start: LightParameters | None = None,
    free: Sequence[str] = ("slope_raw_per_mm", "zero_raw", "noise_raw"),
) -> FittedSensor[LightParameters]:
    """Fit the parameters named in `free` by maximum likelihood; all others stay as in `start`.

    Args:
        readings: raw, shape (polls,), NaN where not sampled.
        truth: where the sensor was at each poll.
        start: where to begin; a straight line through the readings by default.
        free: names out of `FREE`.

    Raises:
        SensorError: a name that cannot be fitted, or too few readings.
    """
    wanted = chosen(FREE, free, readings, "light sensor")
    return fit_free(
        lambda parameters: log_likelihood(parameters, readings, truth),
        start or straight_line(readings, truth.position_mm),
        wanted,
    )


def straight_line(readings: FloatArray, position_mm: FloatArray) -> LightParameters:
    """The ideal sensor nearest to the readings in the least-squares sense."""
    inside = ~np.isnan(readings) & (readings > 0.0) & (readings < HIGHEST_RAW)
    if np.count_nonzero(inside) < 3 or np.ptp(position_mm[inside]) == 0.0:
        return LightParameters(
            zero_raw=float(np.nanmean(readings)), noise_raw=float(np.nanstd(readings)) + 0.3
        )
    slope, zero = np.polyfit(position_mm[inside], readings[inside], 1)
    left = readings[inside] - slope * position_mm[inside] - zero
    return LightParameters(float(slope), float(zero), max(float(np.std(left)), 0.3))
