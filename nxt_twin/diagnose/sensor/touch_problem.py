"""The touch sensor as the search sees it: an item is a stroke, from one switching to the next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from functools import cached_property
from typing import Any, final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.diagnose.diagnosis import Estimate
from nxt_twin.diagnose.sensor.declaration import SensorEffect
from nxt_twin.diagnose.sensor.problem import Mask, Values, free_of, plain_estimates
from nxt_twin.diagnose.sensor.runs import SensorRun
from nxt_twin.diagnose.sensor.touch_effects import hysteresis
from nxt_twin.sensors.fitting import Free
from nxt_twin.sensors.touch import Stroke as StrokeKind
from nxt_twin.sensors.touch import (
    Strokes,
    TouchParameters,
    TouchTruth,
    first_guess,
    log_likelihood_strokes,
    predict,
    simulate,
    strokes_of,
)

_RARE = 1e-3  # probability of a wrong reading at which a fit begins
_FIELDS = tuple(field.name for field in fields(TouchParameters))


@final
class TouchProblem:
    """A case about a touch sensor: one force (or travel) at which it switches, and its scatter.

    Args:
        runs: the recordings.
        channel: their column.
        given: the baseline of the case.
        truth: the rig's column that it is held against.
    """

    unit = "pressed"

    def __init__(self, runs: tuple[SensorRun, ...], channel: str, given: TouchParameters, truth: str) -> None:
        self.runs, self.channel, self.truth, self._given = runs, channel, truth, given
        self._stroke: StrokeKind = "force_g" if truth == "rig_force_g" else "travel_mm"
        self._strokes_of_runs = [strokes_of(run.readings, run.truth[truth]) for run in runs]
        self.item_run: IntArray = np.repeat(
            np.arange(len(runs)), [strokes.at.size for strokes in self._strokes_of_runs]
        )
        self._strokes = Strokes(
            *(
                np.concatenate([getattr(strokes, field.name) for strokes in self._strokes_of_runs])
                for field in fields(Strokes)
            )
        )
        self.item_time_s = np.concatenate(
            [
                run.time_s[strokes.at.astype(np.int64)]
                for run, strokes in zip(runs, self._strokes_of_runs, strict=True)
            ]
        )
        self.effects = (hysteresis(self._stroke),)
        self._unit_of_noise = "force_noise_g" if self._stroke == "force_g" else "travel_noise_mm"

    @cached_property
    def covariates(self) -> Mapping[str, FloatArray]:
        """Time, press against release, and which recording."""
        several = {"recording": self.item_run.astype(np.float64)} if len(self.runs) > 1 else {}
        return {"elapsed_time_s": self.item_time_s, "pressing": self._strokes.closes, **several}

    @property
    def untouched(self) -> frozenset[str]:
        """Nothing of this sensor goes with time."""
        return frozenset({"elapsed_time_s", "recording"})

    @cached_property
    def regimes(self) -> Mapping[str, Mask]:
        """Pressing and releasing, late strokes."""
        return {
            "rising": self._strokes.closes > 0.5,
            "falling": self._strokes.closes < 0.5,
            "elapsed_time": self.item_time_s > np.median(self.item_time_s),
        }

    def base(self) -> Sequence[Free]:
        """Where it switches, with what scatter, and how often a reading is wrong."""
        force = self._stroke == "force_g"
        top, scale = (1000.0, 1.0) if force else (10.0, 0.05)
        least = 0.02 if force else 5e-4
        return (
            Free(f"switch_{self._stroke}", 0.0, top, scale),
            Free(self._unit_of_noise, least, 0.3 * top, 0.2 * scale),
            Free("misread_probability", 1e-4, 0.3, 0.01),
        )

    def base_start(self) -> Values:
        """Halfway between where it was seen to close and to open."""
        known = np.array([not run.held_out for run in self.runs])[self.item_run]
        strokes = Strokes(*(getattr(self._strokes, field.name)[known] for field in fields(Strokes)))
        guess = first_guess(strokes, self._stroke)
        gap = abs(np.subtract(*guess.thresholds(self._stroke)[:2]))
        values: dict[str, float] = dict.fromkeys(_FIELDS, np.nan)
        values |= {
            name: float(value) for name in _FIELDS if (value := getattr(self._given, name)) is not None
        }
        values[f"switch_{self._stroke}"] = getattr(guess, f"switch_{self._stroke}")
        values[self._unit_of_noise] = getattr(guess, self._unit_of_noise) + 0.5 * float(gap)
        values["misread_probability"] = _RARE
        return values

    def free(self, effect: SensorEffect) -> Sequence[Free]:
        """The two thresholds."""
        return free_of(effect)

    def off(self, effect: SensorEffect) -> Values:
        """One threshold."""
        return {part.field: np.nan for part in effect.parameters}

    def run_bound(self, run: int) -> frozenset[str]:
        """Nothing belongs to one run."""
        del run
        return frozenset()

    def starts(self, effect: SensorEffect, values: Values) -> Sequence[Values]:
        """The medians of where it was seen to close and to open."""
        del effect, values
        guess = first_guess(self._strokes, self._stroke)
        press, release, noise = guess.thresholds(self._stroke)
        own = {f"press_{self._stroke}": press, f"release_{self._stroke}": release}
        return [{**own, self._unit_of_noise: noise}, {**own, self._unit_of_noise: 0.2 * noise}]

    def log_each(self, values: Values) -> FloatArray:
        """Exact for a threshold that lies between two polls."""
        return log_likelihood_strokes(self._sensor(values), self._strokes, self._stroke)

    def log_prior(self, values: Values) -> float:
        """It never opens at more than it closes at."""
        press, release, noise = self._sensor(values).thresholds(self._stroke)
        return -0.5 * float(max(release - press, 0.0) / (0.1 * noise)) ** 2

    def scores(self, values: Values, rng: Generator) -> FloatArray:
        """How far the middle of the two polls lies from the threshold, in standard deviations of both."""
        del rng
        press, release, noise = self._sensor(values).thresholds(self._stroke)
        strokes = self._strokes
        width = strokes.high - strokes.low
        whole = np.isfinite(width) & (width > 0.0)
        middle = np.where(whole, 0.5 * (strokes.low + strokes.high), np.nan)
        width = np.where(whole, width, np.nan)
        error = middle - np.where(strokes.closes > 0.5, press, release)
        return np.asarray(error / np.sqrt(noise**2 + width**2 / 12.0), dtype=np.float64)

    def predict(self, values: Values, run: int) -> FloatArray:
        """0 or 1, run freely from an open switch."""
        return predict(self._sensor(values), TouchTruth(self.runs[run].truth[self.truth], self._stroke))

    def draw(self, values: Values, run: int, rng: Generator) -> FloatArray:
        """0 or 1, each stroke with a threshold of its own."""
        return simulate(self._sensor(values), TouchTruth(self.runs[run].truth[self.truth], self._stroke), rng)

    def rows_of_items(self, run: int, chosen: Mask) -> Mask:
        """The rows from one switching to the next."""
        strokes = self._strokes_of_runs[run]
        rows = np.arange(self.runs[run].readings.size)
        stroke = np.minimum(np.searchsorted(strokes.at, rows), strokes.at.size - 1)
        return np.asarray(chosen[self.item_run == run][stroke], dtype=np.bool_)

    def estimates(
        self, effect: SensorEffect, values: Values, names: Sequence[str], covariance: FloatArray
    ) -> dict[str, Estimate]:
        """As fitted."""
        return plain_estimates(effect, values, names, covariance)

    def to_config(self, values: Values, active: frozenset[str]) -> dict[str, Any]:
        """The sensor's own keys."""
        del active
        return self._sensor(values).to_config()

    def _sensor(self, values: Values) -> TouchParameters:
        known = {name: values[name] for name in _FIELDS if not np.isnan(values[name])}
        return TouchParameters(**known)
