"""What changed in a robot's motors and body, from powers that both sides hold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.diagnosis import FoundEffect
from nxt_twin.diagnose.robot.choice import WeighedSubsets, beyond, weigh
from nxt_twin.diagnose.robot.effects import LIBRARY
from nxt_twin.diagnose.robot.moved_motors import MOTORS, motor_key
from nxt_twin.diagnose.robot.powered_fit import PoweredFit, values_at
from nxt_twin.diagnose.robot.powered_search import (
    MATTERS,
    PLACES,
    fit_body,
    found_powered,
    sizes_that_matter,
    with_unknown_load,
)
from nxt_twin.diagnose.robot_changed.joint import FittedSide, JointSides, joint
from nxt_twin.diagnose.robot_changed.side import RobotSide
from nxt_twin.physics.robot.drive import DifferentialDrive, Geometry
from nxt_twin.physics.robot.dynamics import NAMES
from nxt_twin.physics.robot.powered import powered_robot

_SUSPECT_SIGMAS: Final = 3.0  # standard deviations by which a motor's number has to differ to be weighed
_MOST_SUSPECTS: Final = 6  # numbers of motors that are weighed among the candidates, the clearest ones
_DAILY_SHARE: Final = 0.015  # of a motor's number: how far it varies from day to day, one standard deviation
_LEAST_SHARE: Final = 0.03
"""A motor's number that differs by less is not named."""


@final
@dataclass(frozen=True)
class BodyChanges:
    """What differs in motors and body.

    Attributes:
        weighed: which candidates are called for.
        sides: both sides' numbers, by `dynamics.NAMES`; those of motors are logarithms of their share of the given.
        places: of each candidate.
        clusters: how many independent parts they rest on.
        given: the numbers of `dynamics.NAMES` as the model came.
        geometry: wheels and track after.
    """

    weighed: WeighedSubsets
    sides: JointSides
    places: dict[str, list[int]]
    clusters: int
    given: FloatArray
    geometry: Geometry

    def effect(self, of: str) -> FoundEffect:
        """An effect of the body as it is after."""
        covariance = self.sides.before_covariance + self.sides.off_covariance
        values = values_at(self.given, self.sides.after)
        covariance = with_unknown_load(covariance, values, self.geometry)
        return found_powered(LIBRARY[of], values, covariance, self.clusters)


def body_changes(
    sides: tuple[RobotSide, RobotSide], drive: DifferentialDrive, geometries: tuple[Geometry, Geometry]
) -> BodyChanges:
    """Fit motors and body of each side, and weigh what differs.

    Args:
        sides: before and after, both with powers.
        drive: the robot as its model came.
        geometries: of both sides.
    """
    before, after = (
        fit_body(side.case.recordings, drive, geometry, side.found.slips)[0]
        for side, geometry in zip(sides, geometries, strict=True)
    )
    one, other = _side(before), _side(after)
    suspects = _suspects(one, other)
    # All other numbers are alike on both sides, which tells a payload from motors that only might be others.
    may = [place for places in PLACES.values() for place in places] + suspects
    freed = joint(one, other, range(len(NAMES)), may)
    able = {
        name: places
        for name, places in PLACES.items()
        if float(np.max(np.abs(freed.off[places]))) > MATTERS[name]
    }
    able |= {motor_key(place): [place] for place in suspects}
    clusters = min(before.clusters, after.clusters)
    least = sizes_that_matter()
    least[suspects] = _LEAST_SHARE
    weighed = weigh(able, beyond(freed.off, least), freed.off_covariance, clusters)
    differs = [place for name in weighed.best for place in able[name]]
    both = joint(one, other, range(len(NAMES)), differs)
    return BodyChanges(weighed, both, able, clusters, powered_robot(drive).values, geometries[1])


def _suspects(before: FittedSide, after: FittedSide) -> list[int]:
    """Numbers of motors that differ clearly if they alone differ, the clearest first."""
    far = {}
    for place in MOTORS:
        alone = joint(before, after, range(len(NAMES)), [place])
        off, std = abs(alone.off[place]), float(np.sqrt(alone.off_covariance[place, place]))
        if off > max(_LEAST_SHARE, _SUSPECT_SIGMAS * std):
            far[place] = off / std
    return sorted(far, key=lambda place: -far[place])[:_MOST_SUSPECTS]


def _side(fit: PoweredFit) -> FittedSide:
    """A fit's numbers; those of motors also vary a little from day to day."""
    daily = np.zeros(len(NAMES))
    daily[: len(MOTORS)] = _DAILY_SHARE
    return FittedSide(fit.off, fit.covariance + np.diag(daily**2), fit.clusters)
