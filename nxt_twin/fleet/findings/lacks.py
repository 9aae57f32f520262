"""Which effects units lack."""

from __future__ import annotations

from typing import Final

import numpy as np
import pyarrow.compute as pc
from scipy import stats

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.fleet.findings.columns import Sessions
from nxt_twin.fleet.findings.control import q_values
from nxt_twin.fleet.findings.moderated import FIT_DOF, lines, two_sided
from nxt_twin.fleet.findings.values import LEVEL, UNKNOWN, EffectShare, Lack

_USUAL_ALARM: Final = 0.05
"""False alarm rate of an engine that tells none: that of sensors and robots."""


def lacks(sessions: Sessions) -> tuple[list[Lack], list[EffectShare]]:
    """Each effect that was found in a unit, the surest first, and the share of units with each effect.

    A finding in k of n sessions has two p-values. One follows from the engine's own false alarm rate (a
    binomial tail), the other from the size over its standard deviation. The smaller counts, doubled. Tests
    are all effects that were tried in all units.
    """
    known = _of_effects(sessions)
    unknown = _of_unknown(sessions)
    p = np.concatenate([known[1], unknown[1]])
    tried = np.zeros(len(sessions.units))
    np.maximum.at(tried, sessions.unit, np.maximum(sessions.tried, len(sessions.effects.names)) + 1.0)
    q = q_values(p, int(tried.sum()))
    found = [_with_q(lack, rate) for lack, rate in zip([*known[0], *unknown[0]], q.tolist(), strict=True)]
    return sorted(found, key=lambda lack: (lack.q, lack.unit)), _shares(found, len(sessions.units))


def _with_q(lack: Lack, q: float) -> Lack:
    return Lack(**{**vars(lack), "q": q})


def _of_effects(sessions: Sessions) -> tuple[list[Lack], FloatArray]:
    effects = sessions.effects
    kinds = max(len(effects.names), 1)
    group = sessions.unit[effects.row] * kinds + effects.name
    pairs, own = np.unique(group, return_inverse=True)
    fitted = lines(own, pairs.size, np.zeros(own.size), effects.value, effects.std)
    size_p = np.ones(pairs.size)
    np.minimum.at(size_p, own, two_sided(effects.value / effects.std, FIT_DOF))
    of_unit = np.bincount(sessions.unit, minlength=len(sessions.units))[pairs // kinds]
    chance = _chance(sessions, pairs // kinds, fitted.count, of_unit)
    listed = [
        Lack(
            sessions.units[pair // kinds],
            effects.names[pair % kinds],
            int(fitted.count[n]),
            int(of_unit[n]),
            effects.parameter[pair % kinds],
            float(fitted.mean[n]),
            float(fitted.mean_std[n]),
            1.0,
        )
        for n, pair in enumerate(pairs.tolist())
    ]
    return listed, np.minimum(2.0 * np.minimum(chance, of_unit * size_p), 1.0)


def _of_unknown(sessions: Sessions) -> tuple[list[Lack], FloatArray]:
    is_unknown = np.asarray(pc.equal(sessions.table["verdict"], "unexplained").to_numpy(), dtype=bool)
    count = np.bincount(sessions.unit[is_unknown], minlength=len(sessions.units))
    of_unit = np.bincount(sessions.unit, minlength=len(sessions.units))
    units = np.flatnonzero(count)
    listed = [
        Lack(sessions.units[n], UNKNOWN, int(count[n]), int(of_unit[n]), "", np.nan, np.nan, 1.0)
        for n in units.tolist()
    ]
    return listed, _chance(sessions, units, count[units], of_unit[units])


def _chance(sessions: Sessions, units: IntArray, found: IntArray, of: IntArray) -> FloatArray:
    """How often a clean unit would have this number of false alarms."""
    alarm = np.where(np.isfinite(sessions.alarm), sessions.alarm, _USUAL_ALARM)
    largest = np.zeros(len(sessions.units))
    np.maximum.at(largest, sessions.unit, alarm)
    return np.asarray(stats.binom.sf(found - 1, of, largest[units]), dtype=np.float64)


def _shares(found: list[Lack], units: int) -> list[EffectShare]:
    ids = sorted({lack.effect for lack in found})
    shares = []
    for effect in ids:
        own = [lack for lack in found if lack.effect == effect]
        interval = stats.binomtest(len(own), units).proportion_ci(0.95, method="wilson")
        sure = sum(lack.q <= LEVEL for lack in own)
        shares.append(EffectShare(effect, len(own), sure, units, float(interval.low), float(interval.high)))
    return sorted(shares, key=lambda share: -share.found)
