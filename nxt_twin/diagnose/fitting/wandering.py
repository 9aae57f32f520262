"""The courses of a stamps' lag that a structure's residuals suggest: thousands are weighed by two runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.nuisance import Nuisance
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import Plant

_PROBE_SPAN_S = 0.04  # of the waves by which the response of readings to a lag is measured
_PROBE_PERIOD_S = 4.0  # of those waves
_BIN_S = 0.06  # of the time since a recording began, within which a lag is one number
_MOST_BINS = 3000  # of the longest recording
_BINS_A_PERIOD = 8  # at least
_LEAST_PERIODS = 1.5  # in the longest recording: a part of one more is a trend
_FASTEST_S, _SLOWEST_S = 0.5, 300.0  # periods
_PERIODS = 120  # that are tried, evenly by frequency
_SHAPES = (  # rise, straightness, and as many phases as show its quickest part
    (0.5, 0.0, 12),
    (0.5, 1.0, 12),
    (0.04, 1.0, 36),
    (0.96, 1.0, 36),
)
_BEST_OF_A_SHAPE = 3  # phases of one period and shape that are compared with others
_KEPT = 6  # courses that are run
_CHANCE_NATS = 10.0  # that the best of so many courses promises where no stamp is late: 4 to 13
_APART = 0.9  # correlation of two courses above which the lesser one is left out
_LARGE = 0.3  # share of a second wave
_MOST_SPAN_S = 0.3  # of a start
_USUAL_LATENESS = (0.5, 0.0)  # of rows that chance makes late, in spans


@final
@dataclass(frozen=True)
class _Wave:
    """A wave of one period and shape that goes from 1 at whole turns down to -1 and back in `rise` of a turn."""

    period_s: float
    phase: float
    rise: float
    straightness: float


_PROBE = _Wave(_PROBE_PERIOD_S, 0.0, 0.5, 0.0)
_QUARTER = (0.0, -0.25)  # the phases of a cosine and a sine


@final
@dataclass(frozen=True)
class _Course:
    """A wave, its lag of unit span over the bins, and what it promises at which span."""

    wave: _Wave
    lag: FloatArray
    gain: float
    span_s: float


def wandering_starts(nuisance: Nuisance, plant: Plant, effect: Effect) -> list[dict[str, float]]:
    """Starts of `effect`, a lag of whole rows that wanders, SI by symbol, likeliest first.

    A reading answers to the lag and its rate of change at that moment: two waves a quarter of a turn apart show both.
    """
    probe = _start(_PROBE_SPAN_S, _PROBE) | {"lag_mean": 0.0}
    probes = [plant.with_effect(effect.id, {**probe, "lag_phase": phase}) for phase in _QUARTER]
    courses = _Response(nuisance, probes).likeliest(_SHAPES, _KEPT)
    found = [_start(one.span_s, one.wave) for one in courses if one.gain > _CHANCE_NATS]
    return found + late_by_chance_starts(max(job.signals.late_span_s for job in nuisance.jobs))


def late_by_chance_starts(span_s: float) -> list[dict[str, float]]:
    """Starts of a lag that neighbouring stamps tell; none where they tell none.

    A command acts when its row was due, or when it was stamped. The usual lateness may be in other numbers already.
    """
    if span_s <= 0.0:
        return []
    return [
        _start(span_s, _PROBE) | {"waves": 0.0, "of_commands": late, "lag_mean": mean}
        for late in (1.0, 0.0)
        for mean in _USUAL_LATENESS
    ]


def second_waves(nuisance: Nuisance, plant: Plant, effect: Effect) -> list[tuple[float, Plant]]:
    """`plant`, whose lag wanders by one wave, with second ones and the gain that each promises, nats, best first."""
    first = {
        parameter.symbol: plant.values[Slot(effect.id, parameter.symbol)] for parameter in effect.parameters
    }
    if first["second_share"] > 0.0 or first["waves"] == 0.0:
        return []
    probe = _beside(first, _PROBE_SPAN_S, _PROBE)
    probes = [plant.with_effect(effect.id, {**probe, "second_phase": phase}) for phase in _QUARTER]
    return [
        (one.gain, plant.with_effect(effect.id, _beside(first, one.span_s, one.wave)))
        for one in _Response(nuisance, probes).likeliest(_SHAPES[:1], _KEPT)
    ]


def second_wave_alone(plant: Plant, effect: Effect) -> Plant | None:
    """`plant`, whose lag wanders by two waves, with the second alone where that is a large one; else None."""
    own = {each.symbol: plant.values[Slot(effect.id, each.symbol)] for each in effect.parameters}
    share = own["second_share"]
    if share <= _LARGE:
        return None
    wave = _Wave(own["second_period"], own["second_phase"], 0.5, 0.0)
    alone = _start(share * own["lag_span"], wave) | {"rate_error": own["rate_error"]}
    return plant.with_effect(effect.id, alone | {"of_commands": own["of_commands"]})


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


def _beside(first: Mapping[str, float], span_s: float, wave: _Wave) -> dict[str, float]:
    """The lag by `first` and a wave of this span round zero on top of it."""
    whole_s = first["lag_span"] + span_s
    return {
        **first,
        "lag_span": whole_s,
        "lag_mean": first["lag_mean"] * first["lag_span"] / whole_s,
        "second_share": span_s / whole_s,
        "second_period": wave.period_s,
        "second_phase": wave.phase,
    }


@final
class _Response:
    """What a lag does to the residuals, binned over the time since each recording began.

    Args:
        nuisance: the residuals, and what else explains them.
        probes: two plants whose lags wander by `_PROBE`, and by that wave a quarter of a turn later.
    """

    def __init__(self, nuisance: Nuisance, probes: Sequence[Plant]) -> None:
        self._nuisance = nuisance
        parts = zip(nuisance.jobs, nuisance.masks, strict=True)
        elapsed_s = [job.signals.time_s[mask] - job.signals.time_s[0] for job, mask in parts]
        self._length_s = max((float(each[-1]) for each in elapsed_s if each.size), default=0.0)
        self._bin_s = max(_BIN_S, self._length_s / _MOST_BINS)
        bins = int(self._length_s / self._bin_s) + 1
        self._middle_s = (np.arange(bins) + 0.5) * self._bin_s
        self._residual = np.zeros((2, bins))
        self._slopes = np.zeros((2, bins, nuisance.gradient.size))
        self._power = np.zeros((3, bins))
        for number, (at_s, both) in enumerate(zip(elapsed_s, nuisance.signatures(probes), strict=True)):
            place = np.minimum((at_s / self._bin_s).astype(np.int64), bins - 1)
            self._add(place, _responses(both, at_s), nuisance.residual[number], nuisance.slopes[number])

    def _add(
        self,
        place: FloatArray,
        responses: tuple[FloatArray, FloatArray],
        residual: FloatArray,
        slopes: FloatArray,
    ) -> None:
        bins = self._middle_s.size
        held, growing = responses
        for row, response in enumerate(responses):
            self._residual[row] += np.bincount(place, response * residual, bins)
            for n, slope in enumerate(slopes):
                self._slopes[row, :, n] += np.bincount(place, response * slope, bins)
        for row, product in enumerate((held * held, held * growing, growing * growing)):
            self._power[row] += np.bincount(place, product, bins)

    def likeliest(self, shapes: Sequence[tuple[float, float, int]], most: int) -> list[_Course]:
        """The courses that promise most, none like another: of any period, in some shapes, each in some phases."""
        found: list[_Course] = []
        if self._length_s < _LEAST_PERIODS * _FASTEST_S:
            return found
        for period_s in self._periods_s():
            for rise, straightness, phases in shapes:
                waves = [
                    _Wave(float(period_s), _within(n / phases), rise, straightness) for n in range(phases)
                ]
                found += self._promising(waves)
        found.sort(key=lambda one: -one.gain)
        kept: list[_Course] = []
        for one in found:
            if len(kept) < most and all(np.corrcoef(one.lag, other.lag)[0, 1] < _APART for other in kept):
                kept.append(one)
        return kept

    def _promising(self, waves: list[_Wave]) -> list[_Course]:
        phases = np.array([wave.phase for wave in waves])
        turns = self._middle_s / waves[0].period_s + phases[:, None]
        lag = 0.5 * lag_wave(turns, waves[0].rise, waves[0].straightness)
        growth = np.gradient(lag, self._bin_s, axis=1)
        fit = lag @ self._residual[0] + growth @ self._residual[1]
        power = lag**2 @ self._power[0] + 2.0 * (lag * growth) @ self._power[1] + growth**2 @ self._power[2]
        along = lag @ self._slopes[0] + growth @ self._slopes[1]
        fit, power = self._nuisance.projected(fit, power, along)
        span_s = np.clip(fit / np.maximum(power, 1e-9), 0.0, _MOST_SPAN_S)
        gain = span_s * fit - 0.5 * span_s**2 * power
        return [
            _Course(waves[n], lag[n], float(gain[n]), float(span_s[n]))
            for n in np.argsort(-gain)[:_BEST_OF_A_SHAPE]
            if gain[n] > 0.0
        ]

    def _periods_s(self) -> FloatArray:
        slowest = min(max(self._length_s / _LEAST_PERIODS, 2.0 * _FASTEST_S), _SLOWEST_S)
        fastest = max(_FASTEST_S, _BINS_A_PERIOD * self._bin_s)
        return np.asarray(1.0 / np.linspace(1.0 / slowest, 1.0 / fastest, _PERIODS))


def _responses(signatures: FloatArray, elapsed_s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """What a lag of 1 s, and one that grows by 1 s a second, do to each reading, from two waves' signatures."""
    rate = 2.0 * np.pi / _PROBE_PERIOD_S
    cosine, sine = np.cos(rate * elapsed_s), np.sin(rate * elapsed_s)
    half = 0.5 * _PROBE_SPAN_S
    held = (signatures[0] * cosine + signatures[1] * sine) / half
    return held, (signatures[1] * cosine - signatures[0] * sine) / (half * rate)


def _within(phase: float) -> float:
    return phase if phase <= 0.5 else phase - 1.0


def _start(span_s: float, wave: _Wave) -> dict[str, float]:
    return {
        "lag_span": span_s,
        "lag_mean": 0.5,
        "rate_error": 0.0,
        "lag_period": wave.period_s,
        "lag_phase": wave.phase,
        "lag_rise": wave.rise,
        "lag_straightness": wave.straightness,
        "second_share": 0.0,
        "second_period": 2.0,
        "second_phase": 0.0,
        "waves": 1.0,
        "of_commands": 1.0,
    }
