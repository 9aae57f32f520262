"""The ultrasonic sensor as the search sees it: an item is a reading."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from functools import cached_property
from itertools import product
from typing import Any, final

import numpy as np
from numpy.random import Generator
from scipy.special import ndtri

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.diagnosis import Estimate
from nxt_twin.diagnose.sensor.declaration import SensorEffect
from nxt_twin.diagnose.sensor.problem import Mask, Values, free_of, plain_estimates
from nxt_twin.diagnose.sensor.runs import SensorRun
from nxt_twin.diagnose.sensor.ultrasonic_effects import DROPOUT, EFFECTS
from nxt_twin.sensors.fitting import Free
from nxt_twin.sensors.ultrasonic import (
    LAYOUT,
    NO_ECHO,
    UltrasonicParameters,
    UltrasonicTruth,
    between_targets_mm,
    echo_moments,
    log_likelihood_each,
    reading_probability,
    simulate,
)

_DISTANCE, _ANGLE = "rig_distance_mm", "rig_angle_deg"
_ZERO_STD_MM = 4.0  # standard deviation of the prior of where a whole centimetre ends
_USUAL_BEND, _BEND_STD = 1.3, 0.7
_RARE = 1e-3  # least probability of a missed and of a stray echo in a fit: keeps the likelihood robust
_MOST_THRESHOLDS = 100  # distances at which a threshold is tried, at most
_OBLIQUE_DEG = 10.0  # incidence above which a reading is oblique
_LEAST_ANGLES_DEG = 3.0  # range of incidence that has to be exceeded for angles to be examined
_NEAR_MM = 250.0  # distance below which a reading is near
_FIELDS = tuple(field.name for field in fields(UltrasonicParameters))


@final
class UltrasonicProblem:
    """A case about an ultrasonic sensor.

    Its base is the ideal sensor: true distance, whole centimetres, a fixed noise. `zero_mm` is fitted beside
    the noise, with a prior no wider than rounding against cutting off, since nobody knows which a sensor does.

    Args:
        runs: the recordings.
        channel: their column.
        given: the baseline of the case.
    """

    unit = "cm"
    truth = _DISTANCE

    def __init__(self, runs: tuple[SensorRun, ...], channel: str, given: UltrasonicParameters) -> None:
        self.runs, self.channel, self._given = runs, channel, given
        sizes = [run.readings.size for run in runs]
        self.item_run = np.repeat(np.arange(len(runs)), sizes)
        self.item_time_s = np.concatenate([run.time_s for run in runs])
        self._readings = np.clip(np.rint(np.concatenate([run.readings for run in runs])), 0.0, NO_ECHO)
        self._truths = UltrasonicTruth(
            np.concatenate([run.truth[_DISTANCE] for run in runs]),
            np.concatenate([_angles(run) for run in runs]),
        )
        table = np.column_stack([self._readings, self._truths.distance_mm, self._truths.incidence_deg])
        distinct, self._places = np.unique(table, axis=0, return_inverse=True)
        self._distinct = np.ascontiguousarray(distinct.T)
        turned = np.ptp(self._truths.incidence_deg) > _LEAST_ANGLES_DEG
        self.effects = tuple(effect for effect in EFFECTS if turned or effect is not DROPOUT)

        self._rare = {name: getattr(given, name) for name in ("miss_probability", "stray_probability")}

    @cached_property
    def covariates(self) -> Mapping[str, FloatArray]:
        """Distance, incidence, time, and which recording."""
        several = {"recording": self.item_run.astype(np.float64)} if len(self.runs) > 1 else {}
        turned = {"angle_deg": self._truths.incidence_deg}
        return {
            "distance_mm": self._truths.distance_mm,
            "elapsed_time_s": self.item_time_s,
            **several,
            **(turned if np.ptp(self._truths.incidence_deg) > _LEAST_ANGLES_DEG else {}),
        }

    @property
    def untouched(self) -> frozenset[str]:
        """Nothing of this sensor goes with time."""
        return frozenset({"elapsed_time_s", "recording"})

    @cached_property
    def regimes(self) -> Mapping[str, Mask]:
        """Near and far, square on and oblique, with and without echo."""
        distance, angle = self._truths.distance_mm, self._truths.incidence_deg
        return {
            "near": distance < _NEAR_MM,
            "far": distance > np.quantile(distance, 0.67),
            "oblique": angle > _OBLIQUE_DEG,
            "no_echo": self._readings >= NO_ECHO,
            "elapsed_time": self.item_time_s > np.median(self.item_time_s),
        }

    def base(self) -> Sequence[Free]:
        """Noise, and where between rounding and cutting off the whole centimetres lie."""
        return (Free("noise_mm", 0.5, 400.0, 1.0), Free("zero_mm", -8.0, 8.0, 1.0))

    def base_start(self) -> Values:
        """The given sensor, its noise from the readings' spread."""
        echo = self._readings < NO_ECHO
        error = 10.0 * self._readings[echo] - self._truths.distance_mm[echo]
        spread = float(1.48 * np.median(np.abs(error - np.median(error)))) if echo.any() else 10.0
        rare = {
            "miss_probability": max(self._given.miss_probability, _RARE),
            "stray_probability": max(self._given.stray_probability, _RARE),
        }
        values: dict[str, float] = {name: float(getattr(self._given, name)) for name in _FIELDS}
        return {**values, **rare, "noise_mm": max(spread, 2.0)}

    def free(self, effect: SensorEffect) -> Sequence[Free]:
        """The effect's parameters."""
        return free_of(effect)

    def off(self, effect: SensorEffect) -> Values:
        """The effect's defaults."""
        own = LAYOUT.effects[effect.id].values()
        ideal = UltrasonicParameters()
        return {name: float(getattr(ideal, name)) for name in own}

    def run_bound(self, run: int) -> frozenset[str]:
        """Nothing belongs to one run."""
        del run
        return frozenset()

    def starts(self, effect: SensorEffect, values: Values) -> Sequence[Values]:
        """Places to begin; thresholds are tried all along the range."""
        match effect.id:
            case "ultrasonic_blind_zone":
                return [self._blind(float(below)) for below in self._between(400.0)]
            case "ultrasonic_near_offset":
                return self._near(values)
            case "ultrasonic_range_noise":
                return [
                    {
                        "noise_per_distance": k,
                        "noise_mm": max(values["noise_mm"] * share, 1.0),
                        "noise_power": power,
                    }
                    for power, k, share in product((1.0, 2.0), (0.003, 0.01, 0.03, 0.08), (1.0, 0.3))
                ]
            case "ultrasonic_dropout":
                return [
                    {
                        "max_angle_deg": widest, "best_distance_mm": best, "beam_edge_deg": 2.0,
                        "beam_near_shape": 2.0, "beam_far_shape": shape,
                        "contact_angle_deg": near * widest, "far_angle_deg": far * widest,
                    }
                    for widest, best, near, far, shape in product(
                        (12.0, 20.0, 30.0, 42.0, 55.0, 70.0), (250.0, 438.0, 700.0, 1000.0), (0.4, 0.9), (0.1, 0.6),
                        (1.0, 2.0),
                    )
                ]  # fmt: skip
            case _:
                return [{"air_temperature_c": warmth} for warmth in (-10.0, 0.0, 10.0, 30.0, 40.0, 55.0)]

    def _between(self, highest_mm: float) -> FloatArray:
        return between_targets_mm(self._distinct[1], highest_mm, _MOST_THRESHOLDS)

    def _blind(self, below: float) -> Values:
        inside = self._truths.distance_mm < below
        silent = self._readings[inside] >= NO_ECHO
        said = 10.0 * self._readings[inside][~silent]
        return {
            "blind_distance_mm": below,
            "blind_silent_share": float(np.clip(silent.mean(), 0.02, 0.98)) if silent.size else 0.9,
            "blind_reading_mm": float(np.median(said)) if said.size else 30.0,
            "blind_spread_mm": float(np.std(said)) + 6.0 if said.size else 10.0,
        }

    def _near(self, values: Values) -> Sequence[Values]:
        mean, _, none = echo_moments(self._sensor(values), self._truths)
        told = (self._readings < NO_ECHO) & (none < 0.5)
        starts = []
        for below in self._between(1000.0):
            near = told & (self._truths.distance_mm < below)
            if near.any():
                offset = 10.0 * float(np.median((self._readings - mean)[near]))
                quiet = {"near_offset_mm": offset, "near_below_mm": float(below), "near_share": 0.95}
                starts += [quiet, {**quiet, "noise_mm": max(0.5 * values["noise_mm"], 1.0)}]
        return starts

    def log_each(self, values: Values) -> FloatArray:
        """Exact for whole centimetres; equal readings of equal targets are reckoned once."""
        readings, distance_mm, angle_deg = self._distinct
        each = log_likelihood_each(self._sensor(values), readings, UltrasonicTruth(distance_mm, angle_deg))
        return np.asarray(each[self._places], dtype=np.float64)

    def log_prior(self, values: Values) -> float:
        """The zero is no more than a matter of rounding, and a beam's edge is no more than a little bent."""
        bends = (values["beam_near_shape"] - _USUAL_BEND, values["beam_far_shape"] - _USUAL_BEND)
        bent = sum(bend**2 for bend in bends) / _BEND_STD**2
        return -0.5 * ((values["zero_mm"] / _ZERO_STD_MM) ** 2 + bent)

    def scores(self, values: Values, rng: Generator) -> FloatArray:
        """The reading's place in its own distribution, ties broken at random, as a normal score."""
        sensor, below = self._sensor(values), np.zeros(self._readings.size)
        for reading in range(int(NO_ECHO)):
            later = self._readings > reading
            if later.any():
                part = UltrasonicTruth(self._truths.distance_mm[later], self._truths.incidence_deg[later])
                below[later] += reading_probability(sensor, np.full(int(later.sum()), float(reading)), part)
        own = reading_probability(sensor, self._readings, self._truths)
        place = below + own * rng.random(own.size)
        return np.asarray(ndtri(np.clip(place, 1e-9, 1.0 - 1e-9)), dtype=np.float64)

    def predict(self, values: Values, run: int) -> FloatArray:
        """The mean of readings with an echo; 255 where none is the more likely."""
        here = self.runs[run]
        return predicted_cm(self._sensor(values), here.truth[_DISTANCE], _angles(here))

    def draw(self, values: Values, run: int, rng: Generator) -> FloatArray:
        """Whole centimetres, without the rare faults that only make the likelihood robust."""
        here = self.runs[run]
        truth = UltrasonicTruth(here.truth[_DISTANCE], _angles(here))
        return simulate(replace(self._sensor(values), **self._rare), truth, rng)

    def rows_of_items(self, run: int, chosen: Mask) -> Mask:
        """Each row is an item."""
        return np.asarray(chosen[self.item_run == run], dtype=np.bool_)

    def estimates(
        self, effect: SensorEffect, values: Values, names: Sequence[str], covariance: FloatArray
    ) -> dict[str, Estimate]:
        """As fitted."""
        return plain_estimates(effect, values, names, covariance)

    def to_config(self, values: Values, active: frozenset[str]) -> dict[str, Any]:
        """The sensor's own keys."""
        del active
        return replace(self._sensor(values), **self._rare).to_config()

    def _sensor(self, values: Values) -> UltrasonicParameters:
        return UltrasonicParameters(**{name: values[name] for name in _FIELDS})


def predicted_cm(sensor: UltrasonicParameters, distance_mm: FloatArray, angle_deg: FloatArray) -> FloatArray:
    """The expected reading, cm, shape as `distance_mm`: 255 where no echo is more likely than one."""
    mean, _, none = echo_moments(sensor, UltrasonicTruth(distance_mm, angle_deg))
    return np.asarray(np.where(none > 0.5, NO_ECHO, np.clip(mean, 0.0, NO_ECHO)), dtype=np.float64)


def _angles(run: SensorRun) -> FloatArray:
    return run.truth.get(_ANGLE, np.zeros(run.readings.size))
