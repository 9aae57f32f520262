"""Parameters by unit: means over sessions, drifts, outliers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray
from nxt_twin.fleet.findings.columns import Sessions
from nxt_twin.fleet.findings.control import q_values
from nxt_twin.fleet.findings.moderated import Lines, lines, two_sided
from nxt_twin.fleet.findings.values import FleetParameter, Outlier, UnitDrift

_FEWEST_UNITS: Final = 5
_NORMAL_MAD: Final = 1.4826


@final
@dataclass(frozen=True)
class ByUnit:
    """Means and slopes of each parameter of each unit, shape (groups,).

    Attributes:
        unit: of each group.
        name: of each group, an index into the parameters' names.
        dated: whether all of the group's sessions are.
        own: the group of each value of the sessions.
        x: when each value was, in days or in sessions since the unit's first.
    """

    unit: IntArray
    name: IntArray
    dated: BoolArray
    own: IntArray
    x: FloatArray
    fitted: Lines


def by_unit(sessions: Sessions) -> ByUnit:
    """Combine the sessions of each unit."""
    values = sessions.parameters
    kinds = max(len(values.names), 1)
    groups, own = np.unique(sessions.unit[values.row] * kinds + values.name, return_inverse=True)
    unit, name = groups // kinds, groups % kinds
    is_dated = np.bincount(sessions.unit[np.isnan(sessions.day)], minlength=len(sessions.units)) == 0
    _, first = np.unique(sessions.unit, return_index=True)
    at = np.where(is_dated[sessions.unit], sessions.day, np.arange(sessions.unit.size, dtype=np.float64))
    since = (at - at[first][sessions.unit]) if first.size else at
    x = since[values.row]
    fitted = lines(own, groups.size, x, values.value, values.std)
    return ByUnit(unit, name, is_dated[unit], own, x, fitted)


def drifts(sessions: Sessions, level: float) -> list[UnitDrift]:
    """Parameters that change over a unit's sessions, at least three, the surest first."""
    units = by_unit(sessions)
    tested = np.flatnonzero(np.isfinite(units.fitted.slope))
    q = q_values(units.fitted.slope_p()[tested])
    chosen = tested[q <= level]
    listed = [
        _drift(sessions, units, int(n), rate) for n, rate in zip(chosen, q[q <= level].tolist(), strict=True)
    ]
    return sorted(listed, key=lambda drift: (drift.q, -abs(drift.slope / drift.slope_std)))


def _drift(sessions: Sessions, units: ByUnit, group: int, q: float) -> UnitDrift:
    values, of = sessions.parameters, np.flatnonzero(units.own == group)
    return UnitDrift(
        sessions.units[units.unit[group]],
        values.names[units.name[group]],
        float(units.fitted.slope[group]),
        float(units.fitted.slope_std[group]),
        "day" if units.dated[group] else "session",
        tuple(units.x[of].tolist()),
        tuple(values.value[of].tolist()),
        tuple(values.std[of].tolist()),
        q,
    )


def outliers(sessions: Sessions, level: float) -> tuple[list[Outlier], list[FleetParameter]]:
    """Units whose parameters are far from the fleet's median, the surest first, and all parameters.

    A unit's distance is held against the fleet's spread and the unit's own doubt together.
    """
    units = by_unit(sessions)
    mean, std = units.fitted.mean, units.fitted.mean_std
    p, found, parameters = [], [], []
    for name in range(len(sessions.parameters.names)):
        of = np.flatnonzero(units.name == name)
        median = float(np.median(mean[of]))
        parameters.append(_parameter(sessions, name, mean[of], median))
        if of.size < _FEWEST_UNITS:
            continue
        spread = _NORMAL_MAD * float(np.median(np.abs(mean[of] - median)))
        far = (mean[of] - median) / np.hypot(spread, std[of])
        p += two_sided(far, of.size - 1.0).tolist()
        typical = int(of[np.argmin(np.abs(mean[of] - median))])
        found += [(int(n), median, spread, typical) for n in of]
    q = q_values(np.array(p))
    listed = [
        _outlier(sessions, units, each, rate)
        for each, rate in zip(found, q.tolist(), strict=True)
        if rate <= level
    ]
    return sorted(listed, key=lambda outlier: (outlier.q, outlier.unit)), parameters


def _parameter(sessions: Sessions, name: int, means: FloatArray, median: float) -> FleetParameter:
    values = sessions.parameters
    return FleetParameter(values.names[name], values.unit[name], tuple(means.tolist()), median)


def _outlier(sessions: Sessions, units: ByUnit, found: tuple[int, float, float, int], q: float) -> Outlier:
    group, median, spread, typical = found
    unit, other = int(units.unit[group]), int(units.unit[typical])
    return Outlier(
        sessions.units[unit],
        sessions.parameters.names[units.name[group]],
        float(units.fitted.mean[group]),
        float(units.fitted.mean_std[group]),
        median,
        spread,
        q,
        _source(sessions, unit),
        (sessions.units[other], _source(sessions, other)),
    )


def _source(sessions: Sessions, unit: int) -> str:
    row = int(np.searchsorted(sessions.unit, unit))
    return str(sessions.table["source"][row].as_py())
