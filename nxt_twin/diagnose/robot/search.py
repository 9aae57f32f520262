"""From a robot's runs to what its model leaves out: clocks, slip, geometry."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.progress import Progress
from nxt_twin.diagnose.robot.choice import GeometryChoice, choose, places_of
from nxt_twin.diagnose.robot.fit import FittedGeometry, fit_windows
from nxt_twin.diagnose.robot.hard_starts import Unlocated, hard_starts, unlocated
from nxt_twin.diagnose.robot.runs import RobotRun
from nxt_twin.diagnose.robot.slip import SlipSpell, find_slip, without_slip
from nxt_twin.diagnose.robot.slip_gain import brings_together
from nxt_twin.diagnose.robot.spread import SessionSpread, spreads
from nxt_twin.diagnose.robot.stack import RunStack, stacked
from nxt_twin.diagnose.robot.tellable import tellable
from nxt_twin.diagnose.robot.windows import DriveState, vector_of
from nxt_twin.physics.robot.drive import Geometry

CLOCK_NATS: Final = 12.0
"""The gain that the recordings' own clocks need beyond their penalty, together or one alone."""

_SHARE_NATS: Final = 4.0  # of each recording's two numbers
_LEAST_LAG_S: Final = 8e-3  # that some recording's lag has to exceed; no clock is fitted otherwise
_BASE: Final = np.array([True, True, True, False, False, False])
_ROUNDS: Final = 2  # of fitting all and locating slip, at most
_ROUNDS_STARTS: Final = 4  # of fitting wheels and locating hard starts anew, where any is located
_MOVED_SIGMAS: Final = 2.0  # standard deviations that wheels or track have to move by to be fitted at the end


@final
@dataclass(frozen=True)
class RobotFindings:
    """The findings of a search.

    Attributes:
        runs: as they were recorded.
        baseline: the geometry re-fitted alone.
        final: with what was found.
        full: with every parameter free.
        choice: which effects of the geometry are named.
        slips: spells, strongest first.
        spread: how sessions differ, by parameter.
    """

    runs: tuple[RobotRun, ...]
    baseline: FittedGeometry
    final: FittedGeometry
    full: FittedGeometry
    choice: GeometryChoice
    slips: tuple[SlipSpell, ...]
    spread: dict[str, SessionSpread]


def start_of(given: Geometry, runs: int) -> DriveState:
    """The state at which a model came, without lags."""
    return DriveState(vector_of(given), np.zeros(runs), np.zeros(runs))


def search(runs: tuple[RobotRun, ...], given: Geometry, progress: Progress) -> RobotFindings:
    """Fit everything, keep what the recordings call for.

    Args:
        runs: to fit.
        given: the geometry as the model came.
        progress: told in words what is being done.
    """
    start = start_of(given, len(runs))
    told = tellable(runs)
    progress("re-fitting wheels and track")
    baseline = fit_windows(stacked(runs), start, _BASE & told, clock=False)
    progress("fitting markers and clocks")
    slips = _hard_starts(runs, start, told)
    unseen = unlocated(runs, slips, given)
    for _ in range(_ROUNDS):
        mended = mend(runs, slips)
        full = _with_clock_if_needed(stacked(mended), start, told, unseen)
        more = find_slip(mended, full.state.as_geometry, wheels_at(stacked(mended), full.state))
        if not more:
            break
        progress("locating slip")
        slips = merged(slips, more)
    kept = _explaining(runs, slips, full)
    if len(kept) < len(slips):
        slips = kept
        full = _with_clock_if_needed(stacked(mend(runs, slips)), start, told, unseen)
    choice = choose(full, start.geometry, unseen.geometry if unseen else None)
    free = _moved(full, start)
    for effect in choice.named:
        free[places_of(effect)] = True
    stack = stacked(mend(runs, slips))
    final = fit_windows(stack, start, free, clock=full.clock)
    progress("comparing sessions")
    spread = spreads(stack.runs, final, start)
    return RobotFindings(runs, baseline, final, full, choice, slips, spread)


def _explaining(
    runs: tuple[RobotRun, ...], slips: tuple[SlipSpell, ...], full: FittedGeometry
) -> tuple[SlipSpell, ...]:
    """The spells, if taking them out brings paths nearer their poses; else those at hard starts alone."""
    hard = tuple(slip for slip in slips if slip.lost is not None)
    names = {slip.recording for slip in slips if slip.lost is None}
    if not names:
        return slips
    slipping, gripping = (wheels_at(stacked(mend(runs, some)), full.state) for some in (hard, slips))
    place = [index for index, run in enumerate(runs) if run.name in names]
    some, geometry = [runs[index] for index in place], full.state.as_geometry
    sides = ([wheels[index] for index in place] for wheels in (slipping, gripping))
    return slips if brings_together(some, geometry, *sides) else hard


def _hard_starts(runs: tuple[RobotRun, ...], start: DriveState, told: BoolArray) -> tuple[SlipSpell, ...]:
    """Slip at hard starts. What it lost is counted by the robot's own wheels, and these are fitted without it."""
    slips = hard_starts(runs, start.as_geometry)
    for _ in range(_ROUNDS_STARTS if slips else 0):
        fitted = fit_windows(stacked(mend(runs, slips)), start, told, clock=False)
        slips = hard_starts(runs, fitted.state.as_geometry)
    return slips


def refit(
    runs: tuple[RobotRun, ...], given: Geometry, found: RobotFindings, slips: Sequence[SlipSpell]
) -> tuple[FittedGeometry, FittedGeometry]:
    """Baseline and final structure fitted anew to other runs, of which `slips` are known."""
    start = start_of(given, len(runs))
    stack = stacked(mend(runs, slips))
    baseline = fit_windows(stacked(runs), start, found.baseline.free, clock=False)
    return baseline, fit_windows(stack, start, found.final.free, clock=found.final.clock)


def refit_all(runs: tuple[RobotRun, ...], found: RobotFindings) -> FittedGeometry:
    """Every parameter that `found` could tell, fitted anew to some of its runs."""
    stack = stacked(mend(runs, found.slips))
    start = DriveState(found.full.state.geometry, np.zeros(len(runs)), np.zeros(len(runs)))
    return fit_windows(stack, start, found.full.free, clock=found.full.clock)


def mend(runs: tuple[RobotRun, ...], slips: Sequence[SlipSpell]) -> tuple[RobotRun, ...]:
    """The runs without the angles that slipped."""
    return tuple(without_slip(run, [slip for slip in slips if slip.recording == run.name]) for run in runs)


def merged(slips: Sequence[SlipSpell], more: Sequence[SlipSpell]) -> tuple[SlipSpell, ...]:
    """Spells of two rounds, strongest first; what a second round finds of the same spell adds to it."""
    return tuple(sorted([*slips, *more], key=lambda slip: -slip.strength))


def wheels_at(stack: RunStack, state: DriveState) -> list[tuple[FloatArray, FloatArray]]:
    """Each run's wheel angles when its poses were taken, at every row of the run."""
    found = []
    for index, run in enumerate(stack.runs):
        phase = (run.time_s - run.time_s[0]) / max(float(stack.half_s[index]), 1e-9) - 1.0
        late = state.lag_s[index] + state.rate[index] * stack.half_s[index] * phase
        then = run.time_s - late
        found.append((np.interp(then, run.time_s, run.left_rad), np.interp(then, run.time_s, run.right_rad)))
    return found


def clock_gain(fitted: FittedGeometry) -> float:
    """The gain of the recordings' own clocks beyond their penalty, nats: together, or the best one alone."""
    if not fitted.clock:
        return 0.0
    beyond = fitted.lag_nats - _SHARE_NATS
    return float(max(np.sum(beyond), np.max(beyond)))


def _moved(full: FittedGeometry, start: DriveState) -> BoolArray:
    """Which of the wheels and the track the recordings move at all; what they do not stays as given."""
    std = np.sqrt(np.maximum(np.diag(full.covariance), 1e-30))
    return _BASE & full.free & (np.abs(full.state.geometry - start.geometry) > _MOVED_SIGMAS * std)


def _with_clock_if_needed(
    stack: RunStack, start: DriveState, told: BoolArray, unseen: Unlocated | None
) -> FittedGeometry:
    clocked = fit_windows(stack, start, told, clock=True)
    ends = np.abs(clocked.state.lag_s) + np.abs(clocked.state.rate) * stack.half_s
    if clock_gain(clocked) > CLOCK_NATS and np.max(
        ends[clocked.lag_nats > _SHARE_NATS], initial=0.0
    ) > _LEAST_LAG_S + (unseen.lag_s if unseen else 0.0):
        return clocked
    return fit_windows(stack, start, told, clock=False)
