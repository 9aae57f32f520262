"""Do groups of recordings agree on a parameter, and how far from each other are they?"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from scipy.special import chdtrc

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.robot.fit import FittedGeometry, fit_windows
from nxt_twin.diagnose.robot.runs import RobotRun
from nxt_twin.diagnose.robot.stack import stacked
from nxt_twin.diagnose.robot.tellable import tellable
from nxt_twin.diagnose.robot.windows import PARAMETERS, DriveState

_FEWEST_GROUPS: Final = 3  # sessions, else recordings, below which no spread is told
_DISAGREES: Final = 0.01  # probability by chance above which groups agree
_TELLS: Final = 5.0  # a group counts where its doubt is within so many times the best group's


@final
@dataclass(frozen=True)
class SessionSpread:
    """How one parameter differs from group to group, beyond the groups' own doubts.

    Attributes:
        between: standard deviation between groups; 0 where they agree.
        p_value: of the disagreement by chance.
        values: each group's own value, by its name.
    """

    between: float
    p_value: float
    values: dict[str, float]


def spreads(runs: tuple[RobotRun, ...], whole: FittedGeometry, start: DriveState) -> dict[str, SessionSpread]:
    """For each free parameter, how sessions differ; recordings where there are too few sessions.

    Args:
        runs: those that were fitted.
        whole: the fit of all together.
        start: the values given.
    """
    groups = _groups(runs)
    if len(groups) < _FEWEST_GROUPS:
        return {}
    own = [_fit_group(runs, rows, whole, start) for rows in groups.values()]
    values = np.array([fitted.state.geometry for fitted in own])
    variances = np.array([np.where(one.free, np.diag(one.covariance), np.inf) for one in own])
    return {
        name: _spread(list(groups), values[:, place], variances[:, place])
        for place, name in enumerate(PARAMETERS)
        if whole.free[place]
    }


def _groups(runs: tuple[RobotRun, ...]) -> dict[str, list[int]]:
    by_session: dict[str, list[int]] = {}
    for index, run in enumerate(runs):
        by_session.setdefault(run.session, []).append(index)
    if len(by_session) >= _FEWEST_GROUPS:
        return by_session
    return {run.name: [index] for index, run in enumerate(runs)}


def _fit_group(
    runs: tuple[RobotRun, ...], rows: list[int], whole: FittedGeometry, start: DriveState
) -> FittedGeometry:
    some = DriveState(start.geometry, start.lag_s[rows], start.rate[rows])
    group = [runs[row] for row in rows]
    return fit_windows(stacked(group), some, whole.free & tellable(group), clock=whole.clock)


def _spread(names: list[str], values: FloatArray, variances: FloatArray) -> SessionSpread:
    """The method of moments of DerSimonian and Laird (1986) for a random effect."""
    kept: BoolArray = np.isfinite(variances) & (variances <= _TELLS**2 * np.min(variances))
    if np.count_nonzero(kept) < _FEWEST_GROUPS:
        return SessionSpread(0.0, 1.0, {})
    v, weight = values[kept], 1.0 / variances[kept]
    mean = float(np.sum(weight * v) / np.sum(weight))
    scatter = float(np.sum(weight * (v - mean) ** 2))
    freedom = v.size - 1
    p_value = float(chdtrc(freedom, scatter))
    told = {name: float(value) for name, value, here in zip(names, values, kept, strict=True) if here}
    if p_value > _DISAGREES:
        return SessionSpread(0.0, p_value, told)
    scale = float(np.sum(weight) - np.sum(weight**2) / np.sum(weight))
    return SessionSpread(float(np.sqrt(max(scatter - freedom, 0.0) / scale)), p_value, told)
