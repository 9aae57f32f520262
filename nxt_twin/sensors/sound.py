"""The sound sensor: loudness in dB or dBA as a 10-bit reading that falls as it gets louder.

The paper leaves it out. A-weighting: IEC 61672-1. The firmware's range (raw 162 is 100 %): LEGO NXT firmware 1.29,
c_input.h. One assumption: percent grows as a compressed power of the sound pressure. It is set so that
speech at 60 dB gives about 20 %, and 90 dB gives 100 %. LEGO's guide gives these figures for quiet talk and shouting.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray
from nxt_twin.sensors.config import Configured, SensorLayout
from nxt_twin.sensors.converter import HIGHEST_RAW, converted, log_probability_each
from nxt_twin.sensors.expected import Expected
from nxt_twin.sensors.fitting import FittedSensor, Free, chosen, fit_free

LAYOUT = SensorLayout("sound_sensor", {})


@final
@dataclass(frozen=True)
class SoundParameters(Configured):
    """A sound sensor.

    Attributes:
        silent_raw: the reading in silence.
        loud_raw: the reading at `loud_db`, and the lowest that the amplifier gives.
        loud_db: the level that reaches the amplifier's end, dB (dBA where weighted).
        exponent: of the pressure: 1 would be proportional to it, 0.5 its root.
        noise_raw: standard deviation before rounding.
        weighted: 1 for the dBA mode, which hears as an ear does; 0 for dB.
    """

    layout: ClassVar[SensorLayout] = LAYOUT

    silent_raw: float = 1000.0
    loud_raw: float = 162.0
    loud_db: float = 90.0
    exponent: float = 0.466
    noise_raw: float = 6.0
    weighted: float = 0.0


@final
@dataclass(frozen=True)
class SoundTruth:
    """Level (dB of sound pressure) and frequency (Hz; None is 1 kHz) of a tone at each poll, shape (polls,)."""

    level_db: FloatArray
    frequency_hz: FloatArray | None = None


FREE: tuple[Free, ...] = (
    Free("silent_raw", 0.0, 1200.0, 5.0),
    Free("loud_raw", 0.0, 1023.0, 5.0),
    Free("loud_db", 50.0, 140.0, 1.0),
    Free("exponent", 0.05, 2.0, 0.02),
    Free("noise_raw", 0.1, 300.0, 0.5),
)
"""The parameters that can be fitted, with their bounds. `loud_db` only where readings reach the end."""


def a_weighting_db(frequency_hz: FloatArray) -> FloatArray:
    """The A-weighting of IEC 61672-1, dB, 0 at 1 kHz; shape as `frequency_hz`."""
    f2 = np.maximum(frequency_hz, 1e-3) ** 2
    top = 12194.0**2 * f2**2
    bottom = (f2 + 20.6**2) * np.sqrt((f2 + 107.7**2) * (f2 + 737.9**2)) * (f2 + 12194.0**2)
    return np.asarray(20.0 * np.log10(top / bottom) + 2.0, dtype=np.float64)


def mean_raw(parameters: SoundParameters, truth: SoundTruth) -> FloatArray:
    """The reading's mean before noise and rounding, shape (polls,); it stops at `loud_raw`."""
    p, level = parameters, truth.level_db
    if p.weighted and truth.frequency_hz is not None:
        level = level + p.weighted * a_weighting_db(truth.frequency_hz)
    share = np.minimum(10.0 ** (p.exponent * (level - p.loud_db) / 20.0), 1.0)
    return np.asarray(p.silent_raw + (p.loud_raw - p.silent_raw) * share, dtype=np.float64)


def log_likelihood(parameters: SoundParameters, readings: FloatArray, truth: SoundTruth) -> float:
    """The log-likelihood of the raw readings, nats; exact for a rounded reading."""
    mean = mean_raw(parameters, truth)
    return float(np.sum(log_probability_each(readings, mean, parameters.noise_raw, "sound sensor")))


def simulate(parameters: SoundParameters, truth: SoundTruth, rng: Generator) -> FloatArray:
    """Raw readings 0 to 1023, shape (polls,), drawn from the model."""
    noise = parameters.noise_raw * rng.standard_normal(truth.level_db.size)
    return converted(mean_raw(parameters, truth) + noise)


def expected(parameters: SoundParameters, level_db: float, frequency_hz: float = 1000.0) -> Expected:
    """The sensor's expected reading, raw, for one tone."""
    truth = SoundTruth(np.array([level_db]), np.array([frequency_hz]))
    mean = float(np.clip(mean_raw(parameters, truth)[0], 0.0, HIGHEST_RAW))
    return Expected(mean, parameters.noise_raw**2 + 1.0 / 12.0, 0.0)


def fit(
    readings: FloatArray,
    truth: SoundTruth,
    *,
    start: SoundParameters | None = None,
    free: Sequence[str] = ("silent_raw", "loud_raw", "exponent", "noise_raw"),
) -> FittedSensor[SoundParameters]:
    """Fit the parameters named in `free` by maximum likelihood; all others stay as in `start`.

    Args:
        readings: raw, shape (polls,), NaN where not sampled.
        truth: the tone at each poll.
        start: where to begin; the defaults if None.
        free: names out of `FREE`.

    Raises:
        SensorError: a name that cannot be fitted, or too few readings.
    """
    wanted = chosen(FREE, free, readings, "sound sensor")
    return fit_free(
        lambda parameters: log_likelihood(parameters, readings, truth),
        start or SoundParameters(),
        wanted,
    )
