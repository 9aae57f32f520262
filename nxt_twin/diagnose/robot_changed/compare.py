"""From recordings of a robot before and after to what differs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.diagnose.changed.answer import Changes
from nxt_twin.diagnose.robot.choice import WeighedSubsets, beyond, weigh
from nxt_twin.diagnose.robot.engine import robot_of
from nxt_twin.diagnose.robot.held_out import JudgedRun, judged_run
from nxt_twin.diagnose.robot.judge import RobotModel
from nxt_twin.diagnose.robot.leftover import RobotLeft, short_errors, what_is_left
from nxt_twin.diagnose.robot.runs import RobotRun
from nxt_twin.diagnose.robot.search import mend, refit_all, wheels_at
from nxt_twin.diagnose.robot.stack import stacked
from nxt_twin.diagnose.robot_changed.body import body_changes
from nxt_twin.diagnose.robot_changed.joint import FittedSide, JointSides, joint
from nxt_twin.diagnose.robot_changed.places import CHANGED_PARTS, geometry_of, movable, movable_slopes
from nxt_twin.diagnose.robot_changed.side import RobotSide, side_of
from nxt_twin.diagnose.robot_changed.telling import RobotSides, told
from nxt_twin.physics.robot.drive import DifferentialDrive, Geometry
from nxt_twin.recording.case import Case

_FOLDS: Final = 4  # of the runs after, at most, where none is held out: each is predicted by a fit without it
_RELATIVE: Final = 3
"""Of a side's numbers, how many are compared relative to the given ones."""


@final
@dataclass(frozen=True)
class _Geometries:
    """What differs in wheels, track and markers."""

    weighed: WeighedSubsets
    sides: JointSides
    told: list[int]
    differs: list[int]


def robots_changed(
    before: Case, afters: Sequence[Case], progress: Callable[[str], None] = lambda _: None
) -> list[Changes]:
    """Say for each of `afters` what differs in a robot on two wheels, if anything.

    Args:
        before: its plant is the model of all sides.
        afters: their plants play no part.
        progress: told in words what is being done.

    Raises:
        DiagnosisError: a side lacks wheels or a pose from outside, or does not drive.
        PlantError: a key or value of the model that is none.
    """
    drive = robot_of(before)
    progress(f"fitting {before.name}")
    first = side_of(before, drive)
    found = []
    for case in afters:
        progress(f"comparing {case.name} with {before.name}")
        found.append(_compared(first, side_of(case, drive), drive))
    return found


def _compared(before: RobotSide, after: RobotSide, drive: DifferentialDrive) -> Changes:
    sides = _geometries(before, after, drive.geometry)
    body = None
    if before.powered and after.powered:
        geometries = geometry_of(sides.sides.before), geometry_of(sides.sides.after)
        body = body_changes((before, after), drive, geometries)
    judged = _judged(before, after, sides, drive.geometry)
    left = _new_left(before, after, sides.sides)
    return told(RobotSides(drive, before, after, sides.weighed, sides.sides, sides.told, body, judged, left))


def _geometries(before: RobotSide, after: RobotSide, given: Geometry) -> _Geometries:
    one, other = before.fitted, after.fitted
    told_places = [int(place) for place in np.flatnonzero(before.told & after.told)]
    off = other.values - one.values
    size = np.ones(off.size)
    size[:_RELATIVE] = given.left_wheel_radius_m, given.right_wheel_radius_m, given.track_m
    able = {
        each.of: places
        for each in CHANGED_PARTS
        if (places := [place for place in each.places if place in told_places])
        and any(
            abs(off[place]) > least * size[place]
            for place, least in zip(each.places, each.matters, strict=True)
            if place in told_places
        )
    }
    least = np.zeros(off.size)
    for each in CHANGED_PARTS:
        least[list(each.places)] = np.array(each.matters) * size[list(each.places)]
    weighed = weigh(
        able, beyond(off, least), one.covariance + other.covariance, min(one.clusters, other.clusters)
    )
    differs = [place for of in weighed.best for place in able[of]]
    return _Geometries(weighed, joint(one, other, told_places, differs), told_places, differs)


def _judged(
    before: RobotSide, after: RobotSide, sides: _Geometries, given: Geometry
) -> tuple[JudgedRun, ...]:
    """Runs after, each by the robot as before, and with changes that were fitted without it."""
    as_before = RobotModel(geometry_of(before.fitted.values))
    if after.held:
        now = RobotModel(geometry_of(sides.sides.after))
        return tuple(judged_run(run, given, as_before, now) for run in after.held)
    found = []
    folds = min(_FOLDS, len(after.runs))
    for fold in range(folds):
        now = RobotModel(_without(before, after, sides, fold, folds))
        found += [
            judged_run(run, given, as_before, now)
            for index, run in enumerate(after.runs)
            if index % folds == fold
        ]
    return tuple(found)


def _without(before: RobotSide, after: RobotSide, sides: _Geometries, fold: int, folds: int) -> Geometry:
    """The robot after by all runs but those of one fold."""
    if not sides.differs:
        return geometry_of(before.fitted.values)
    kept = tuple(run for index, run in enumerate(after.runs) if index % folds != fold)
    fit = refit_all(kept, after.found)
    turn = movable_slopes(fit.state.geometry)
    side = FittedSide(movable(fit.state.geometry), turn @ fit.covariance @ turn.T, fit.clusters)
    return geometry_of(joint(before.fitted, side, sides.told, sides.differs).after)


def _new_left(before: RobotSide, after: RobotSide, sides: JointSides) -> RobotLeft | None:
    """The most that is left after and is more than noise, unless it was left before too."""
    old = {(one.along, one.channel) for one in _left(before, geometry_of(sides.before))}
    new = [one for one in _left(after, geometry_of(sides.after)) if (one.along, one.channel) not in old]
    return max(new, key=lambda one: one.size * one.nats, default=None)


def _left(side: RobotSide, geometry: Geometry) -> list[RobotLeft]:
    stack = stacked(mend(side.runs, side.found.slips))
    runs: Sequence[RobotRun] = stack.runs
    errors = short_errors(runs, geometry, wheels_at(stack, side.found.full.state))
    return [one for one in what_is_left(errors) if one.is_structured]
