"""The ultrasonic sensor: time of flight, whole centimetres, and where that breaks down.

Source of the effects: Gonçalves, Lima, Malheiros, Costa, *Sensor and actuator stochastic modeling of the Lego
Mindstorms NXT educational kit*, section III.C. Speed of sound in dry air: c = 331.3 m/s · √(1 + T/273.15 °C).
Default parameters are the ideal sensor: true distance, whole centimetres, small noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.sensors.beam import Beam
from nxt_twin.sensors.errors import SensorError
from nxt_twin.sensors.expected import Expected
from nxt_twin.sensors.fitting import FittedSensor, chosen, fit_free
from nxt_twin.sensors.intervals import interval_probability, logistic
from nxt_twin.sensors.pings import at_pings, first_polls, ping_numbers
from nxt_twin.sensors.ultrasonic_parameters import FREE, LAYOUT, REFERENCE_TEMPERATURE_C, UltrasonicParameters

__all__ = [
    "FREE",
    "LAYOUT",
    "NO_ECHO",
    "REFERENCE_TEMPERATURE_C",
    "UltrasonicParameters",
    "UltrasonicTruth",
    "beam_limit_deg",
    "between_targets_mm",
    "blind_probability",
    "distance_gain",
    "echo_moments",
    "expected",
    "fit",
    "log_likelihood",
    "log_likelihood_each",
    "mean_mm",
    "near_probability",
    "noise_std_mm",
    "reading_probability",
    "silent_probability",
    "simulate",
    "sound_speed",
]

NO_ECHO = 255.0
"""The reading without an echo, cm."""

_THRESHOLDS = ("blind_distance_mm", "near_below_mm")
_KELVIN = 273.15
_LEAST = 1e-280
_LARGEST_READING = 254.0


@final
@dataclass(frozen=True)
class UltrasonicTruth:
    """The target of the sensor at each poll; arrays of shape (polls,).

    Attributes:
        distance_mm: of the target along the sensor's axis.
        angle_deg: of incidence, 0 is square on; None is square on throughout.
        time_s: stamps of the polls; needed only where `update_period_s` is not 0.
    """

    distance_mm: FloatArray
    angle_deg: FloatArray | None = None
    time_s: FloatArray | None = None

    @property
    def incidence_deg(self) -> FloatArray:
        """The angle's size, deg."""
        return np.zeros_like(self.distance_mm) if self.angle_deg is None else np.abs(self.angle_deg)


_FREE_BY_NAME = {part.name: part for part in FREE}


def sound_speed(temperature_c: float) -> float:
    """The speed of sound in dry air, m/s: 331.3·√(1 + T/273.15 °C)."""
    return 331.3 * float(np.sqrt(1.0 + temperature_c / _KELVIN))


def distance_gain(parameters: UltrasonicParameters) -> float:
    """By what the true distance is multiplied: the scale, and what the air's temperature does."""
    warmth = sound_speed(REFERENCE_TEMPERATURE_C) / sound_speed(parameters.air_temperature_c)
    return parameters.scale * warmth


def beam_limit_deg(parameters: UltrasonicParameters, distance_mm: FloatArray) -> FloatArray:
    """The incidence at which half of the echoes are lost, deg; shape as `distance_mm`."""
    p = parameters
    beam = Beam(
        p.max_angle_deg,
        p.best_distance_mm,
        p.contact_angle_deg,
        p.far_angle_deg,
        p.far_mm,
        p.beam_near_shape,
        p.beam_far_shape,
    )
    return beam.limit_deg(distance_mm)


def mean_mm(parameters: UltrasonicParameters, truth: UltrasonicTruth) -> FloatArray:
    """The distance that an echo gives on average, before rounding and without the near offset, mm.

    Emitter and receiver stand half a spacing s off the axis. By the mirror image of the emitter, the path to a wall at
    distance d and incidence φ and back is `2·√(d² + (s·cos φ / 2)²)`.
    """
    half = 0.5 * parameters.transducer_spacing_mm * np.cos(np.deg2rad(truth.incidence_deg))
    return distance_gain(parameters) * np.sqrt(truth.distance_mm**2 + half**2) + parameters.zero_mm


def noise_std_mm(parameters: UltrasonicParameters, distance_mm: FloatArray) -> FloatArray:
    """Standard deviation before rounding, mm: (σ0^p + (k·d)^p)^(1/p)."""
    grown, power = parameters.noise_per_distance * distance_mm, parameters.noise_power
    if power == 1.0:
        return parameters.noise_mm + grown
    return np.asarray((parameters.noise_mm**power + grown**power) ** (1.0 / power), dtype=np.float64)


def log_likelihood_each(
    parameters: UltrasonicParameters, readings: FloatArray, truth: UltrasonicTruth
) -> FloatArray:
    """The logarithm of each reading's probability, nats, shape (polls,).

    0 where the reading is NaN, and where it only repeats the last ping's.
    """
    if readings.shape != truth.distance_mm.shape:
        raise SensorError("readings and truth differ in length", where="ultrasonic sensor")
    seen = ~np.isnan(readings)
    if parameters.update_period_s > 0.0:
        time_s = _stamps(truth)
        seen &= first_polls(ping_numbers(time_s, parameters.update_period_s))
        truth = _at_pings(parameters, truth)
    given = np.where(seen, readings, 0.0)
    return np.where(seen, np.log(np.maximum(reading_probability(parameters, given, truth), _LEAST)), 0.0)


def log_likelihood(parameters: UltrasonicParameters, readings: FloatArray, truth: UltrasonicTruth) -> float:
    """The log-likelihood of the readings (cm), nats; exact for a rounded reading."""
    return float(np.sum(log_likelihood_each(parameters, readings, truth)))


def reading_probability(
    parameters: UltrasonicParameters, readings: FloatArray, truth: UltrasonicTruth
) -> FloatArray:
    """The probability of each whole reading (cm, 255 without echo), shape (polls,)."""
    p, distance = parameters, truth.distance_mm
    quantum, none = p.quantum_mm, readings >= NO_ECHO * 10.0 / p.quantum_mm
    mean, std = mean_mm(p, truth), noise_std_mm(p, distance)
    near = near_probability(p, distance)
    plain = _rounded(readings, mean, std, quantum)
    offset = _rounded(readings, mean + p.near_offset_mm, std, quantum) if p.near_offset_mm else plain
    measured = (1.0 - near) * plain + near * offset
    if p.stray_probability:
        anywhere = np.where(none, 0.0, 1.0 / (_LARGEST_READING + 1.0))
        measured = (1.0 - p.stray_probability) * measured + p.stray_probability * anywhere
    silent = silent_probability(p, truth)
    blind = blind_probability(p, distance)
    chance = (1.0 - blind) * (silent * none + (1.0 - silent) * measured)
    if p.blind_distance_mm > 0.0:
        spread = np.full_like(distance, p.blind_spread_mm)
        said = _rounded(readings, np.full_like(distance, p.blind_reading_mm), spread, quantum)
        chance += blind * (p.blind_silent_share * none + (1.0 - p.blind_silent_share) * said)
    if p.crosstalk_per_mm:
        lost = (1.0 - blind) * silent + blind * p.blind_silent_share
        beyond = interval_probability((readings * quantum - mean) / std, np.full_like(mean, np.inf))
        chance = _with_crosstalk(p, chance, readings, none, lost + (1.0 - lost) * beyond)
    return np.asarray(chance, dtype=np.float64)


def near_probability(parameters: UltrasonicParameters, distance_mm: FloatArray) -> FloatArray:
    """The probability that a reading carries the near offset."""
    edge = (parameters.near_below_mm - distance_mm) / parameters.near_edge_mm
    return parameters.near_share * logistic(edge)


def blind_probability(parameters: UltrasonicParameters, distance_mm: FloatArray) -> FloatArray:
    """The probability that the target is too near to be measured."""
    if parameters.blind_distance_mm <= 0.0:
        return np.zeros_like(distance_mm)
    return logistic((parameters.blind_distance_mm - distance_mm) / parameters.blind_edge_mm)


def silent_probability(parameters: UltrasonicParameters, truth: UltrasonicTruth) -> FloatArray:
    """The probability that no echo comes back, by incidence or by chance."""
    missed = np.full_like(truth.distance_mm, parameters.miss_probability)
    if parameters.max_angle_deg >= 180.0:
        return missed
    limit = beam_limit_deg(parameters, truth.distance_mm)
    heard = logistic((limit - truth.incidence_deg) / parameters.beam_edge_deg)
    return 1.0 - heard * (1.0 - missed)


def _rounded(readings: FloatArray, mean: FloatArray, std: FloatArray, quantum: float) -> FloatArray:
    """Probability of whole readings of a normal distance; 0 takes all below, 255 all above."""
    low = np.where(readings <= 0.0, -np.inf, ((readings - 0.5) * quantum - mean) / std)
    high = np.where(readings >= NO_ECHO * 10.0 / quantum, np.inf, ((readings + 0.5) * quantum - mean) / std)
    return interval_probability(low, high)


def _with_crosstalk(
    p: UltrasonicParameters,
    chance: FloatArray,
    readings: FloatArray,
    none: BoolArray,
    standing: FloatArray,
) -> FloatArray:
    """The probability where another sensor's ping, at a place that is uniform, may come first.

    Either the own reading stands and the foreign ping comes later, or that ping comes here and the own one,
    which is still `standing` with that probability, would come later.
    """
    reach = (_LARGEST_READING + 0.5) * p.quantum_mm
    later = np.maximum(1.0 - p.crosstalk_per_mm * np.minimum(readings * p.quantum_mm, reach), 0.0)
    width = p.quantum_mm * np.where(readings <= 0.0, 0.5, 1.0)
    foreign = np.where(none, 0.0, p.crosstalk_per_mm * width)
    return np.asarray(chance * later + foreign * standing, dtype=np.float64)


def simulate(parameters: UltrasonicParameters, truth: UltrasonicTruth, rng: Generator) -> FloatArray:
    """Readings in whole cm, 255 without echo, shape (polls,), drawn from the model."""
    if parameters.update_period_s > 0.0:
        numbers = ping_numbers(_stamps(truth), parameters.update_period_s)
        first = first_polls(numbers)
        pinged = simulate(replace(parameters, update_period_s=0.0), _at_pings(parameters, truth), rng)
        return np.asarray(pinged[first][np.cumsum(first) - 1], dtype=np.float64)
    p, count = parameters, truth.distance_mm.size
    chance = rng.random((5, count))
    distance = mean_mm(p, truth) + noise_std_mm(p, truth.distance_mm) * rng.standard_normal(count)
    distance += np.where(chance[0] < near_probability(p, truth.distance_mm), p.near_offset_mm, 0.0)
    stray = chance[1] < p.stray_probability
    distance = np.where(stray, np.floor(255.0 * rng.random(count)) * p.quantum_mm, distance)
    silent = chance[2] < silent_probability(p, truth)
    blind = chance[3] < blind_probability(p, truth.distance_mm)
    said = p.blind_reading_mm + p.blind_spread_mm * rng.standard_normal(count)
    distance = np.where(blind, said, distance)
    silent = np.where(blind, chance[4] < p.blind_silent_share, silent)
    if p.crosstalk_per_mm:
        foreign = rng.random(count) / p.crosstalk_per_mm
        first = (foreign < distance) | (silent & (foreign <= (_LARGEST_READING + 0.5) * p.quantum_mm))
        distance, silent = np.where(first, foreign, distance), silent & ~first
    whole = np.clip(np.rint(distance / p.quantum_mm), 0.0, NO_ECHO * 10.0 / p.quantum_mm)
    return np.asarray(np.where(silent, NO_ECHO * 10.0 / p.quantum_mm, whole), dtype=np.float64)


def expected(parameters: UltrasonicParameters, distance_mm: float, angle_deg: float = 0.0) -> Expected:
    """The sensor's expected reading, cm, for one target; fast enough for each step of a filter."""
    truth = UltrasonicTruth(np.array([distance_mm]), np.array([angle_deg]))
    mean, variance, p_no_echo = echo_moments(parameters, truth)
    return Expected(float(mean[0]), float(variance[0]), float(p_no_echo[0]))


def echo_moments(
    parameters: UltrasonicParameters, truth: UltrasonicTruth
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mean (cm) and variance (cm²) of a reading with an echo, and the probability of none; shape (polls,) each."""
    p, distance = parameters, truth.distance_mm
    near = near_probability(p, distance) if p.near_offset_mm else np.zeros_like(distance)
    mean = mean_mm(p, truth) + near * p.near_offset_mm
    variance = noise_std_mm(p, distance) ** 2 + near * (1.0 - near) * p.near_offset_mm**2
    blind = blind_probability(p, distance)
    silent = silent_probability(p, truth)
    p_none = (1.0 - blind) * silent + blind * p.blind_silent_share
    talks = blind * (1.0 - p.blind_silent_share)
    share = talks / np.maximum(talks + (1.0 - blind) * (1.0 - silent), 1e-12)
    both = (1.0 - share) * mean + share * p.blind_reading_mm
    variance = (1.0 - share) * (variance + (mean - both) ** 2) + share * (
        p.blind_spread_mm**2 + (p.blind_reading_mm - both) ** 2
    )
    quantum = p.quantum_mm
    return both / quantum, variance / quantum**2 + 1.0 / 12.0, np.asarray(p_none, dtype=np.float64)


def fit(
    readings: FloatArray,
    truth: UltrasonicTruth,
    *,
    start: UltrasonicParameters | None = None,
    free: Sequence[str] = ("noise_mm", "noise_per_distance", "zero_mm", "scale"),
) -> FittedSensor[UltrasonicParameters]:
    """Fit the parameters named in `free` by maximum likelihood; all others stay as in `start`.

    Args:
        readings: cm, shape (polls,), NaN where not sampled.
        truth: the target at each poll.
        start: where to begin; the ideal sensor by default.
        free: names out of `FREE`.

    Raises:
        SensorError: a name that cannot be fitted, or too few readings.
    """
    wanted = chosen(FREE, free, readings, "ultrasonic sensor")
    return fit_free(
        lambda parameters: log_likelihood(parameters, readings, truth),
        _with_thresholds(start or UltrasonicParameters(), readings, truth, free),
        wanted,
    )


def between_targets_mm(distance_mm: FloatArray, highest_mm: float, most: int = 80) -> FloatArray:
    """Distances halfway between neighbouring targets, up to a number of them: where a threshold may lie."""
    places = np.unique(distance_mm[distance_mm <= highest_mm])
    halfway = 0.5 * (places[1:] + places[:-1])
    return (
        halfway[np.unique(np.linspace(0, halfway.size - 1, most).astype(np.int64))]
        if halfway.size
        else halfway
    )


def _with_thresholds(
    start: UltrasonicParameters, readings: FloatArray, truth: UltrasonicTruth, free: Sequence[str]
) -> UltrasonicParameters:
    """The start with each free threshold where it is likeliest, since no gradient leads there."""
    for name in _THRESHOLDS:
        if name in free:
            tried = [start] + [
                replace(start, **{name: float(place)})
                for place in between_targets_mm(truth.distance_mm, _FREE_BY_NAME[name].upper)
            ]
            start = max(tried, key=lambda each: log_likelihood(each, readings, truth))
    return start


def _stamps(truth: UltrasonicTruth) -> FloatArray:
    if truth.time_s is None:
        mend = "give time_s, or set update_period_s to 0"
        raise SensorError(
            "pings at a rate, but the polls have no stamps", where="ultrasonic sensor", mend=mend
        )
    return truth.time_s


def _at_pings(parameters: UltrasonicParameters, truth: UltrasonicTruth) -> UltrasonicTruth:
    time_s, period_s = _stamps(truth), parameters.update_period_s
    angle = None if truth.angle_deg is None else at_pings(truth.angle_deg, time_s, period_s)
    return UltrasonicTruth(at_pings(truth.distance_mm, time_s, period_s), angle, time_s)
