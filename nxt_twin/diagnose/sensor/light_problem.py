"""The light sensor as the search sees it: an item is a reading."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from functools import cached_property
from typing import Any, final

import numpy as np
from numpy.random import Generator
from scipy.special import ndtri

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.diagnosis import Estimate
from nxt_twin.diagnose.sensor.declaration import SensorEffect
from nxt_twin.diagnose.sensor.light_effects import AMBIENT_OFFSET, EFFECTS, FLICKER, SATURATION
from nxt_twin.diagnose.sensor.periods import MAINS_HZ, likeliest_frequencies
from nxt_twin.diagnose.sensor.problem import Mask, Values, free_of, plain_estimates, standard_errors
from nxt_twin.diagnose.sensor.runs import SensorRun
from nxt_twin.sensors.converter import HIGHEST_RAW, interval_of
from nxt_twin.sensors.fitting import Free
from nxt_twin.sensors.intervals import interval_probability
from nxt_twin.sensors.light import (
    LightParameters,
    LightTruth,
    log_likelihood_each,
    mean_raw,
    simulate,
    straight_line,
)

_POSITION = "rig_position_mm"
_NOISE_FLOOR_RAW = 0.3  # least standard deviation of noise that a fit may find
_MAINS_WIDTH_HZ, _ODD_FREQUENCY_NATS = 1.0, 4.0
_FIELDS = tuple(field.name for field in fields(LightParameters))
_AMBIENT, _PHASE = "ambient@", "phase@"


@final
class LightProblem:
    """A case about a light sensor.

    Its base is the ideal sensor: one slope, one offset, one noise for all recordings. Room light is counted from
    the first recording's.

    Args:
        runs: the recordings.
        channel: their column.
        given: the baseline of the case.
    """

    unit = "raw"
    truth = _POSITION

    def __init__(self, runs: tuple[SensorRun, ...], channel: str, given: LightParameters) -> None:
        self.runs, self.channel, self._given = runs, channel, given
        sizes = [run.readings.size for run in runs]
        self.item_run = np.repeat(np.arange(len(runs)), sizes)
        self.item_time_s = np.concatenate([run.time_s for run in runs])
        self._readings = np.concatenate([run.readings for run in runs])
        self._position = np.concatenate([run.truth[_POSITION] for run in runs])
        several = len(runs) > 1
        self.effects = tuple(effect for effect in EFFECTS if several or effect is not AMBIENT_OFFSET)
        self._fitted = np.array([not run.held_out for run in runs])[self.item_run]

    @cached_property
    def covariates(self) -> Mapping[str, FloatArray]:
        """Place, time, and which recording."""
        several = {"recording": self.item_run.astype(np.float64)} if len(self.runs) > 1 else {}
        return {"position_mm": self._position, "elapsed_time_s": self.item_time_s, **several}

    @property
    def untouched(self) -> frozenset[str]:
        """Light may flicker in time, and be another in each recording."""
        return frozenset()

    @cached_property
    def regimes(self) -> Mapping[str, Mask]:
        """High and low readings (dark is high: the reading falls with light on some sensors), late ones."""
        high, low = np.quantile(self._readings, (0.67, 0.33))
        return {
            "bright": self._readings >= high,
            "dark": self._readings <= low,
            "elapsed_time": self.item_time_s > np.median(self.item_time_s),
            **{f"recording {run.name}": self.item_run == i for i, run in enumerate(self.runs) if i < 12},
        }

    def base(self) -> Sequence[Free]:
        """One slope, one zero, one noise."""
        return (
            Free("slope_raw_per_mm", -500.0, 500.0, 0.02),
            Free("zero_raw", -5000.0, 5000.0, 3.0),
            Free("noise_raw", _NOISE_FLOOR_RAW, 500.0, 0.5),
        )

    def base_start(self) -> Values:
        """A straight line through everything that may be fitted."""
        known = self._fitted
        line = straight_line(self._readings[known], self._position[known])
        values = {name: float(getattr(self._given, name) or 0.0) for name in _FIELDS}
        values["knee_raw"] = np.nan if self._given.knee_raw is None else self._given.knee_raw
        for run in range(len(self.runs)):
            values[f"{_AMBIENT}{run}"] = values[f"{_PHASE}{run}"] = 0.0
        return {
            **values,
            "slope_raw_per_mm": line.slope_raw_per_mm,
            "zero_raw": line.zero_raw,
            "noise_raw": max(line.noise_raw, _NOISE_FLOOR_RAW),
        }

    def free(self, effect: SensorEffect) -> Sequence[Free]:
        """The effect's parameters, with those that belong to single runs."""
        known = [index for index, run in enumerate(self.runs) if not run.held_out]
        match effect.id:
            case AMBIENT_OFFSET.id:
                return [Free(f"{_AMBIENT}{index}", -1023.0, 1023.0, 2.0) for index in known[1:]]
            case FLICKER.id:
                phases = [Free(f"{_PHASE}{index}", -20.0, 20.0, 0.3) for index in known]
                return [*free_of(effect), *phases]
            case _:
                return free_of(effect)

    def off(self, effect: SensorEffect) -> Values:
        """The effect's defaults, and no light or phase of single runs."""
        none = {part.field: np.nan if part.default is None else part.default for part in effect.parameters}
        mark = {AMBIENT_OFFSET.id: _AMBIENT, FLICKER.id: _PHASE}.get(effect.id)
        own = {f"{mark}{run}": 0.0 for run in range(len(self.runs))} if mark else {}
        return {**none, **own}

    def run_bound(self, run: int) -> frozenset[str]:
        """The run's room light and the phase of its mains."""
        return frozenset((f"{_AMBIENT}{run}", f"{_PHASE}{run}"))

    def starts(self, effect: SensorEffect, values: Values) -> Sequence[Values]:
        """Room light from each run's median error; knees all along the range; the likeliest frequencies."""
        error = self._readings - mean_raw(self._sensor(values), self._truths(values))
        match effect.id:
            case AMBIENT_OFFSET.id:
                medians = [float(np.median(error[self.item_run == run])) for run in range(len(self.runs))]
                first = next(i for i, run in enumerate(self.runs) if not run.held_out)
                light = {f"{_AMBIENT}{run}": m - medians[first] for run, m in enumerate(medians)}
                noise = max(0.5 * values["noise_raw"], 1.0)
                own = {"zero_raw": values["zero_raw"] + medians[first]}
                return [{**light, **own}, {**light, **own, "noise_raw": noise}]
            case SATURATION.id:
                return self._knees(values)
            case _:
                return self._frequencies(error, values)

    def _knees(self, values: Values) -> Sequence[Values]:
        """The part on this side of a knee gives the line, what is beyond it the width."""
        starts = []
        for side, quantiles in ((1.0, (0.5, 0.65, 0.8, 0.9, 0.96)), (-1.0, (0.5, 0.35, 0.2, 0.1, 0.04))):
            for knee in np.quantile(self._readings[self._fitted], quantiles):
                below = self._fitted & (side * (self._readings - knee) < 0.0)
                if np.count_nonzero(below) < 8 or np.ptp(self._position[below]) == 0.0:
                    continue
                line = straight_line((self._readings - self._ambient(values))[below], self._position[below])
                for width in (3.0, 30.0, 120.0):
                    starts.append(
                        {
                            "knee_raw": float(knee),
                            "knee_width_raw": width,
                            "knee_side": side,
                            "slope_raw_per_mm": line.slope_raw_per_mm,
                            "zero_raw": line.zero_raw,
                            "noise_raw": max(line.noise_raw, 1.0),
                        }
                    )
        return starts

    def _frequencies(self, error: FloatArray, values: Values) -> Sequence[Values]:
        parts = [
            (self.item_time_s[self.item_run == i], error[self.item_run == i])
            for i, run in enumerate(self.runs)
            if not run.held_out
        ]
        known = [i for i, run in enumerate(self.runs) if not run.held_out]
        starts = []
        for peak in likeliest_frequencies(parts):
            phases = {f"{_PHASE}{run}": phase for run, phase in zip(known, peak.phases_rad, strict=True)}
            starts.append(
                {
                    "flicker_frequency_hz": peak.frequency_hz,
                    "flicker_amplitude_raw": peak.amplitude,
                    "noise_raw": max(peak.left, _NOISE_FLOOR_RAW),
                    "zero_raw": values["zero_raw"] + peak.constant,
                    **phases,
                }
            )
        return starts

    def log_each(self, values: Values) -> FloatArray:
        """Exact for whole readings that stop at 0 and 1023."""
        return log_likelihood_each(self._sensor(values), self._readings, self._truths(values))

    def log_prior(self, values: Values) -> float:
        """Lights flicker at the mains' frequency or its double: any other is less likely beforehand."""
        if not values["flicker_amplitude_raw"]:
            return 0.0
        off_mains_hz = min(abs(values["flicker_frequency_hz"] - mains) for mains in MAINS_HZ)
        return 0.0 if off_mains_hz < _MAINS_WIDTH_HZ else -_ODD_FREQUENCY_NATS

    def scores(self, values: Values, rng: Generator) -> FloatArray:
        """The reading's place in its own distribution, ties broken at random, as a normal score."""
        sensor, readings = self._sensor(values), self._readings
        mean = mean_raw(sensor, self._truths(values))
        low, high = interval_of(readings, mean, sensor.noise_raw)
        below = interval_probability(np.full_like(low, -np.inf), low)
        place = below + interval_probability(low, high) * rng.random(low.size)
        return np.asarray(ndtri(np.clip(place, 1e-9, 1.0 - 1e-9)), dtype=np.float64)

    def predict(self, values: Values, run: int) -> FloatArray:
        """The mean reading within the converter's ends."""
        here = self.item_run == run
        mean = mean_raw(self._sensor(values), self._truths(values))[here]
        return np.asarray(np.clip(mean, 0.0, HIGHEST_RAW), dtype=np.float64)

    def draw(self, values: Values, run: int, rng: Generator) -> FloatArray:
        """Whole raw readings."""
        here = self.item_run == run
        drawn = simulate(self._sensor(values), self._truths(values), rng)[here]
        return np.asarray(drawn, dtype=np.float64)

    def rows_of_items(self, run: int, chosen: Mask) -> Mask:
        """Each row is an item."""
        return np.asarray(chosen[self.item_run == run], dtype=np.bool_)

    def estimates(
        self, effect: SensorEffect, values: Values, names: Sequence[str], covariance: FloatArray
    ) -> dict[str, Estimate]:
        """As fitted; of the room light the recording's that differs most from the first's."""
        if effect.id != AMBIENT_OFFSET.id:
            return plain_estimates(effect, values, names, covariance)
        stds = standard_errors(names, covariance)
        own = [name for name in names if name.startswith(_AMBIENT)]
        farthest = max(own, key=lambda name: abs(values[name]))
        return {"offset_raw": Estimate(values[farthest], stds[farthest], "")}

    def to_config(self, values: Values, active: frozenset[str]) -> dict[str, Any]:
        """The sensor's own keys; of the room light and of the phase those of the last recording fitted."""
        last = max(index for index, run in enumerate(self.runs) if not run.held_out)
        sensor = self._sensor(values)
        if AMBIENT_OFFSET.id in active:
            light = [values[f"{_AMBIENT}{index}"] for index in range(last + 1)]
            sensor = replace(sensor, ambient_offset_raw=max(light, key=abs))
        if FLICKER.id in active:
            sensor = replace(sensor, flicker_phase_rad=values[f"{_PHASE}{last}"])
        return sensor.to_config()

    def _sensor(self, values: Values) -> LightParameters:
        knee = None if np.isnan(values["knee_raw"]) else values["knee_raw"]
        return LightParameters(**{**{name: values[name] for name in _FIELDS}, "knee_raw": knee})  # type: ignore[arg-type]

    def _ambient(self, values: Values) -> FloatArray:
        each = np.array([values[f"{_AMBIENT}{run}"] for run in range(len(self.runs))])
        return each[self.item_run]

    def _truths(self, values: Values) -> LightTruth:
        phases = np.array([values[f"{_PHASE}{run}"] for run in range(len(self.runs))])
        return LightTruth(self._position, self.item_time_s, self._ambient(values), phases[self.item_run])
