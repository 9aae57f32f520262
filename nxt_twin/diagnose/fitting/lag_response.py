"""The response of a structure's residuals to a lag of the stamps: thousands of courses are weighed by two runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.diagnose.fitting.nuisance import Nuisance
from nxt_twin.physics.plant import Plant

PROBE_SPAN_S: Final = 0.04  # of the waves by which the response of readings to a lag is measured
_PROBE_PERIOD_S = 4.0  # of those waves
_BIN_S = 0.06  # of the time since a recording began, within which a lag is one number
_MOST_BINS = 3000  # of the longest recording
_BINS_A_PERIOD = 8  # at least
_LEAST_PERIODS = 1.5  # in the longest recording: a part of one more is a trend
_FASTEST_S, _SLOWEST_S = 0.5, 300.0  # periods
_PERIODS = 120  # that are tried, evenly by frequency
SHAPES: Final = (  # rise, straightness, and as many phases as show its quickest part
    (0.5, 0.0, 12),
    (0.5, 1.0, 12),
    (0.04, 1.0, 36),
    (0.96, 1.0, 36),
)
_BEST_OF_A_SHAPE = 3  # phases of one period and shape that are compared with others
_APART = 0.9  # correlation of two courses above which the lesser one is left out
_MOST_SPAN_S = 0.3  # of a start


@final
@dataclass(frozen=True)
class Wave:
    """A wave of one period and shape that goes from 1 at whole turns down to -1 and back in `rise` of a turn."""

    period_s: float
    phase: float
    rise: float
    straightness: float


PROBE: Final = Wave(_PROBE_PERIOD_S, 0.0, 0.5, 0.0)


@final
@dataclass(frozen=True)
class LagCourse:
    """A wave, its lag of unit span over the bins, and what it promises at which span."""

    wave: Wave
    lag: FloatArray
    gain: float
    span_s: float


@final
@dataclass(frozen=True)
class LagCourseApart:
    """A wave with a phase of its own in each recording, by name, and what it promises at which span."""

    wave: Wave
    phases: Mapping[str, float]
    gain: float
    span_s: float


def lag_wave(turns: FloatArray, rise: float, straightness: float) -> FloatArray:
    """The first wave of the lag of `clock_skew` at many moments at once, between -1 and 1, by its turns."""
    part = turns - np.floor(turns)
    fall = 1.0 - rise
    half = np.where(part < fall, 0.5 * part / fall, 1.0 - 0.5 * (1.0 - part) / rise)
    straight = np.abs(4.0 * half - 2.0) - 1.0
    if straightness == 1.0:  # most courses that are tried
        return np.asarray(straight)
    rounded = np.cos(2.0 * np.pi * half)
    return np.asarray(rounded + straightness * (straight - rounded))


@final
class Response:
    """The response of the residuals to a lag, binned over the time since each recording began.

    Args:
        nuisance: the residuals, and what else explains them.
        probes: two plants whose lags wander by `PROBE`, and by that wave a quarter of a turn later.
    """

    def __init__(self, nuisance: Nuisance, probes: Sequence[Plant]) -> None:
        self._nuisance = nuisance
        parts = zip(nuisance.jobs, nuisance.masks, strict=True)
        elapsed_s = [job.signals.time_s[mask] - job.signals.time_s[0] for job, mask in parts]
        self._length_s = max((float(each[-1]) for each in elapsed_s if each.size), default=0.0)
        self._bin_s = max(_BIN_S, self._length_s / _MOST_BINS)
        bins = int(self._length_s / self._bin_s) + 1
        self._middle_s = (np.arange(bins) + 0.5) * self._bin_s
        self._of: dict[str, _Bins] = {}
        for number, (at_s, both) in enumerate(zip(elapsed_s, nuisance.signatures(probes), strict=True)):
            place = np.minimum((at_s / self._bin_s).astype(np.int64), bins - 1)
            own = _binned(
                place, bins, _responses(both, at_s), nuisance.residual[number], nuisance.slopes[number]
            )
            name = nuisance.jobs[number].signals.name
            self._of[name] = self._of[name].beside(own) if name in self._of else own
        first, *others = self._of.values()
        for other in others:
            first = first.beside(other)
        self._all = first

    def likeliest(self, shapes: Sequence[tuple[float, float, int]], most: int) -> list[LagCourse]:
        """The courses that promise most, none like another: of any period, in some shapes, each in some phases."""
        found: list[LagCourse] = []
        for waves in self._waves(shapes):
            found += self._promising(waves)
        found.sort(key=lambda one: -one.gain)
        kept: list[LagCourse] = []
        for one in found:
            if len(kept) < most and all(np.corrcoef(one.lag, other.lag)[0, 1] < _APART for other in kept):
                kept.append(one)
        return kept

    def likeliest_apart(self, shapes: Sequence[tuple[float, float, int]], most: int) -> list[LagCourseApart]:
        """As `likeliest`, of waves that have a phase of their own in each recording."""
        found = [self._apart(waves) for waves in self._waves(shapes)]
        return sorted(found, key=lambda one: -one.gain)[:most]

    def _waves(self, shapes: Sequence[tuple[float, float, int]]) -> Iterator[list[Wave]]:
        """The waves of each period and shape, in all phases."""
        if self._length_s < _LEAST_PERIODS * _FASTEST_S:
            return
        for period_s in self._periods_s():
            for rise, straightness, phases in shapes:
                yield [Wave(float(period_s), _within(n / phases), rise, straightness) for n in range(phases)]

    def _lags(self, waves: list[Wave]) -> tuple[FloatArray, FloatArray]:
        """The lags of unit span over the bins, and their growth, shape (waves, bins)."""
        phases = np.array([wave.phase for wave in waves])
        turns = self._middle_s / waves[0].period_s + phases[:, None]
        lag = 0.5 * lag_wave(turns, waves[0].rise, waves[0].straightness)
        return lag, np.gradient(lag, self._bin_s, axis=1)

    def _promising(self, waves: list[Wave]) -> list[LagCourse]:
        lag, growth = self._lags(waves)
        span_s, gain = _gained(*self._nuisance.projected(*self._all.along(lag, growth)))
        return [
            LagCourse(waves[n], lag[n], float(gain[n]), float(span_s[n]))
            for n in np.argsort(-gain)[:_BEST_OF_A_SHAPE]
            if gain[n] > 0.0
        ]

    def _apart(self, waves: list[Wave]) -> LagCourseApart:
        """The likeliest phase of each recording by itself, and what they promise together."""
        lag, growth = self._lags(waves)
        each = {name: bins.along(lag, growth) for name, bins in self._of.items()}
        best = {name: int(np.argmax(_gained(fit, power)[1])) for name, (fit, power, _) in each.items()}
        chosen = [[part[best[name], None] for part in parts] for name, parts in each.items()]
        fit, power, along = (np.sum(parts, axis=0) for parts in zip(*chosen, strict=True))
        span_s, gain = _gained(*self._nuisance.projected(fit, power, along))
        phases = {name: waves[n].phase for name, n in best.items()}
        return LagCourseApart(waves[0], phases, float(gain[0]), float(span_s[0]))

    def _periods_s(self) -> FloatArray:
        slowest = min(max(self._length_s / _LEAST_PERIODS, 2.0 * _FASTEST_S), _SLOWEST_S)
        fastest = max(_FASTEST_S, _BINS_A_PERIOD * self._bin_s)
        return np.asarray(1.0 / np.linspace(1.0 / slowest, 1.0 / fastest, _PERIODS))


@final
@dataclass(frozen=True)
class _Bins:
    """Products of the two responses with residuals, with slopes and with one another, summed in each bin.

    Attributes:
        residual: shape (2, bins).
        slopes: shape (2, bins, variables).
        power: held by held, held by growing, growing by growing, shape (3, bins).
    """

    residual: FloatArray
    slopes: FloatArray
    power: FloatArray

    def beside(self, other: _Bins) -> _Bins:
        """Both summed."""
        return _Bins(self.residual + other.residual, self.slopes + other.slopes, self.power + other.power)

    def along(self, lag: FloatArray, growth: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Signature · residual, signature · signature and signature · slopes of each lag, shape (lags, ...)."""
        fit = lag @ self.residual[0] + growth @ self.residual[1]
        power = lag**2 @ self.power[0] + 2.0 * (lag * growth) @ self.power[1] + growth**2 @ self.power[2]
        return fit, power, lag @ self.slopes[0] + growth @ self.slopes[1]


def _binned(
    place: IntArray,
    bins: int,
    responses: tuple[FloatArray, FloatArray],
    residual: FloatArray,
    slopes: FloatArray,
) -> _Bins:
    held, growing = responses
    along = [[np.bincount(place, response * slope, bins) for slope in slopes] for response in responses]
    return _Bins(
        np.array([np.bincount(place, response * residual, bins) for response in responses]),
        np.array(along).reshape(2, len(slopes), bins).transpose(0, 2, 1),
        np.array(
            [
                np.bincount(place, one * other, bins)
                for one, other in ((held, held), (held, growing), (growing, growing))
            ]
        ),
    )


def _gained(fit: FloatArray, power: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The span at which each lag gains most, s, and what it gains there, nats."""
    span_s = np.clip(fit / np.maximum(power, 1e-9), 0.0, _MOST_SPAN_S)
    return span_s, span_s * fit - 0.5 * span_s**2 * power


def _responses(signatures: FloatArray, elapsed_s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """What a lag of 1 s, and one that grows by 1 s a second, do to each reading, from two waves' signatures."""
    rate = 2.0 * np.pi / _PROBE_PERIOD_S
    cosine, sine = np.cos(rate * elapsed_s), np.sin(rate * elapsed_s)
    half = 0.5 * PROBE_SPAN_S
    held = (signatures[0] * cosine + signatures[1] * sine) / half
    return held, (signatures[1] * cosine - signatures[0] * sine) / (half * rate)


def _within(phase: float) -> float:
    return phase if phase <= 0.5 else phase - 1.0
