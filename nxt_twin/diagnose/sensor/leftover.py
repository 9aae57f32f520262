"""Is what a structure leaves more than noise, and where does it gather?

The residuals are standard normal scores if the structure is right. Sums of their bin means and bin variances then
have known distributions, and no shuffling is needed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from scipy.special import chdtrc

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.diagnosis import RegimeFinding, Spell
from nxt_twin.diagnose.sensor.problem import SensorProblem

_BINS = 12  # along a covariate, at most
_LEAST_IN_BIN = 5  # scores in a bin, a regime or a window of time, at least
_PER_BIN = 8  # scores to each bin on average, at least
_CLIP = 4.0  # standard deviations to which scores are drawn in, and from which they count as far out
_MOST_SPELLS = 12  # that are told, the strongest
_SPELL_SIGMA = 5.0  # standard deviations beyond noise above which a window's squares belong to a spell
_WINDOWS = 60  # of time in each recording, at most, in which spells are located
_FEWEST_WITH_SPREAD = 40  # scores below which their scatter is not examined


@final
@dataclass(frozen=True)
class Left:
    """The residual along one covariate.

    Attributes:
        along: the covariate, with `spread of` before it where the scatter varies rather than the mean.
        nats: by how much the bins' own means (or variances) would do better than none, less what chance gives.
        size: of the varying part, in standard deviations of the noise.
        p_value: of the nats by chance.
    """

    along: str
    nats: float
    size: float
    p_value: float


def what_is_left(problem: SensorProblem, scores: FloatArray) -> list[Left]:
    """The residual along every covariate, largest first."""
    clipped = np.clip(scores, -_CLIP, _CLIP)
    spread = (clipped**2 - 1.0) / np.sqrt(2.0)
    found = []
    for name, values in problem.covariates.items():
        found.append(_along(name, values, clipped))
        if np.count_nonzero(np.isfinite(scores)) >= _FEWEST_WITH_SPREAD:
            found.append(_along(f"spread of {name}", values, spread))
    finite = np.isfinite(scores)
    far = int(np.count_nonzero(np.abs(scores[finite]) >= _CLIP))
    found.append(_far_out(far, int(finite.sum())))
    return sorted(found, key=lambda left: -left.nats)


def _along(name: str, values: FloatArray, scores: FloatArray) -> Left:
    finite = np.isfinite(scores) & np.isfinite(values)
    v, z = values[finite], scores[finite]
    if v.size < 3 * _LEAST_IN_BIN:
        return Left(name, 0.0, 0.0, 1.0)
    wanted = min(_BINS, v.size // _PER_BIN)
    edges = np.unique(np.quantile(v, np.linspace(0.0, 1.0, wanted + 1)))
    place = np.clip(np.searchsorted(edges, v, side="right") - 1, 0, max(edges.size - 2, 0))
    counts = np.bincount(place)
    sums = np.bincount(place, weights=z)
    full = counts >= _LEAST_IN_BIN
    squares = float(np.sum(sums[full] ** 2 / counts[full]))
    bins = int(full.sum())
    nats = 0.5 * (squares - bins)
    return Left(
        name, nats, float(np.sqrt(max(2.0 * nats, 0.0) / v.size)), float(chdtrc(max(bins, 1), squares))
    )


def _far_out(count: int, of: int) -> Left:
    """Readings farther out than any normal noise would throw them, against one in a thousand."""
    allowed = 2.0 + 2e-3 * of
    nats = float(count * np.log(count / allowed) - count + allowed) if count > allowed else 0.0
    return Left("readings far out", nats, float(count / max(of, 1)) * _CLIP, float(np.exp(-nats)))


def regimes_of(problem: SensorProblem, scores: FloatArray) -> tuple[RegimeFinding, ...]:
    """How far mean and scatter of the residuals in each regime are from noise, strongest first."""
    found = []
    for name, inside in problem.regimes.items():
        z = np.clip(scores[inside & np.isfinite(scores)], -_CLIP, _CLIP)
        if z.size < _LEAST_IN_BIN:
            continue
        strength = float(z.size * z.mean() ** 2 + 0.5 * np.sum(z**2 - 1.0) ** 2 / z.size)
        found.append(RegimeFinding(name, float(np.sqrt(strength)), float(chdtrc(2, strength))))
    return tuple(sorted(found, key=lambda finding: -finding.strength))


def spells_of(problem: SensorProblem, scores: FloatArray) -> tuple[Spell, ...]:
    """The stretches of time whose residuals are far from noise, strongest first."""
    found = []
    for index, run in enumerate(problem.runs):
        here = np.flatnonzero((problem.item_run == index) & np.isfinite(scores))
        if here.size == 0:
            continue
        found += _spells_of_run(run.name, problem.item_time_s[here], np.clip(scores[here], -6.0, 6.0))
    return tuple(sorted(found, key=lambda spell: -spell.strength)[:_MOST_SPELLS])


def _spells_of_run(name: str, time_s: FloatArray, scores: FloatArray) -> list[Spell]:
    """Neighbouring windows that stand out, joined."""
    parts = np.array_split(np.arange(scores.size), min(_WINDOWS, max(1, scores.size // _LEAST_IN_BIN)))
    strengths = [_strength(scores[part]) for part in parts]
    spells: list[Spell] = []
    begin: int | None = None
    for number, strength in enumerate([*strengths, 0.0]):
        if strength > _SPELL_SIGMA:
            begin = number if begin is None else begin
        elif begin is not None:
            first, last = parts[begin][0], parts[number - 1][-1]
            whole = _strength(scores[first : last + 1])
            spells.append(Spell(name, float(time_s[first]), float(time_s[last]), whole))
            begin = None
    return spells


def _strength(scores: FloatArray) -> float:
    """How many standard deviations the sum of squares is beyond noise."""
    return float((np.sum(scores**2) - scores.size) / np.sqrt(2.0 * scores.size))
