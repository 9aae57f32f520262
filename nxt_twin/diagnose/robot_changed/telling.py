"""From what two sides show of a robot before and after to what is said of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from scipy.special import stdtrit

from nxt_twin.diagnose.changed.answer import Change, Changes, ChangeVerdict
from nxt_twin.diagnose.diagnosis import Fit, FoundEffect, Mismatch, Moved, Tolerance
from nxt_twin.diagnose.robot.choice import WeighedSubsets
from nxt_twin.diagnose.robot.effects import POSE_OFFSET, WHEEL_SLIP
from nxt_twin.diagnose.robot.findings import pose_effect, slip_effect
from nxt_twin.diagnose.robot.held_out import JudgedRun, drawn_runs, horizons_of
from nxt_twin.diagnose.robot.leftover import RobotLeft
from nxt_twin.diagnose.robot.powered_fit import values_at
from nxt_twin.diagnose.robot.powered_search import PLACES
from nxt_twin.diagnose.robot_changed import words
from nxt_twin.diagnose.robot_changed.body import BodyChanges
from nxt_twin.diagnose.robot_changed.joint import JointSides
from nxt_twin.diagnose.robot_changed.places import CHANGED_PARTS, MOVABLE, UNITS, geometry_of
from nxt_twin.diagnose.robot_changed.side import RobotSide
from nxt_twin.physics.robot.drive import DifferentialDrive
from nxt_twin.physics.robot.powered import dynamics_config, powered_robot

_METRIC: Final = "position RMSE over whole runs after, from the wheels and the first pose"
_SURE: Final = 0.999  # told probability of slip on one side only: it is located, not weighed
_WAS_THERE: Final = 2.0  # standard deviations from zero beyond which an effect was there before
_OFFSET: Final = (3, 4, 5)


@final
@dataclass(frozen=True)
class RobotSides:
    """All that was found out about a side after.

    Attributes:
        drive: the robot as its model came.
        before, after: the sides.
        weighed: which changes of wheels, track and markers are called for.
        sides: the numbers of both.
        told: places of the numbers that both sides tell.
        body: the changes of motors and body, where both sides hold powers.
        judged: runs after that were not fitted.
        left: what is left after, was not before, and is more than noise.
    """

    drive: DifferentialDrive
    before: RobotSide
    after: RobotSide
    weighed: WeighedSubsets
    sides: JointSides
    told: list[int]
    body: BodyChanges | None
    judged: tuple[JudgedRun, ...]
    left: RobotLeft | None


def told(evidence: RobotSides) -> Changes:
    """The answer for one side after."""
    changes = tuple(sorted(_changes(evidence), key=lambda one: -one.probability))
    verdict: ChangeVerdict = "unexplained" if evidence.left else "changed" if changes else "unchanged"
    horizons = horizons_of(evidence.judged)
    whole = horizons[-1]
    fit = Fit(_METRIC, "mm", whole.baseline, whole.improved, whole.floor, horizons)
    names = evidence.before.case.name, evidence.after.case.name
    return Changes(
        name=names[1],
        before=names[0],
        verdict=verdict,
        sentence=words.sentence(verdict, changes, fit, names),
        changes=changes,
        refit=_shared(evidence),
        effects=_effects(evidence, changes),
        fit=fit,
        tolerance=Tolerance(_half_count_mm(evidence), "mm", whole.improved),
        mismatch=Mismatch("pose_x_m", (), (), "kinematic" if changes else None),
        notes=words.notes(evidence.left, evidence.after, powered=evidence.body is not None),
        held_out=drawn_runs(evidence.judged),
        plant=_plant(evidence),
    )


def _half_count_mm(evidence: RobotSides) -> float:
    """What half a degree of the wheels stands for on the floor."""
    return 1e3 * float(np.radians(0.5)) * evidence.drive.geometry.mean_wheel_radius_m


def _changes(evidence: RobotSides) -> list[Change]:
    found = [
        _of_geometry(candidate.of, list(candidate.places), evidence)
        for candidate in CHANGED_PARTS
        if candidate.of in evidence.weighed.best
    ]
    if evidence.body is not None:
        found += [_of_body(of, evidence.body, evidence) for of in sorted(evidence.body.weighed.best)]
    before, after = evidence.before.found.slips, evidence.after.found.slips
    if bool(before) != bool(after):
        slip = slip_effect(after or before).params["slip_ratio"]
        came, now = (None, slip.value) if after else (slip.value, 0.0)
        interval = (slip.interval_95 if after else None) or (now, now)
        found.append(Change(WHEEL_SLIP.id, came, now, slip.std, "1", interval, _SURE))
    return found


def _of_geometry(of: str, places: list[int], evidence: RobotSides) -> Change:
    sides, reach = evidence.sides, _reach(evidence.after.fitted.clusters)
    stds = np.sqrt(np.diag(sides.off_covariance)[places])
    main = places[int(np.argmax(np.abs(sides.off[places]) / np.maximum(stds, 1e-12)))]
    std = float(np.sqrt(sides.off_covariance[main, main]))
    came, now = float(sides.before[main]), float(sides.after[main])
    unit = UNITS[MOVABLE[main]]
    was_there = abs(came) > _WAS_THERE * float(np.sqrt(sides.before_covariance[main, main]))
    params = {} if of != POSE_OFFSET.id else _pose(evidence).params
    return Change(
        of,
        came if of != POSE_OFFSET.id or was_there else None,
        now,
        std,
        unit,
        (now - reach * std, now + reach * std),
        evidence.weighed.probability[of],
        params,
    )


def _of_body(of: str, body: BodyChanges, evidence: RobotSides) -> Change:
    places, sides, reach = body.places[of], body.sides, _reach(body.clusters)
    std = float(np.sqrt(sides.off_covariance[places[0], places[0]]))
    chance = body.weighed.probability[of]
    if of in PLACES:
        effect = body.effect(of)
        main = next(iter(effect.params.values()))
        came = sides.before[places]
        own = np.sqrt(np.diag(sides.before_covariance)[places])
        there = bool(np.any(np.abs(came) > _WAS_THERE * own))
        size = float(np.linalg.norm(came)) if len(places) > 1 else float(came[0])
        interval = main.interval_95 or (main.value, main.value)
        return Change(
            of, size if there else None, main.value, main.std, main.unit, interval, chance, effect.params
        )
    given = float(powered_robot(evidence.drive).values[places[0]])
    before, after = (given * float(np.exp(one[places[0]])) for one in (sides.before, sides.after))
    wide = after * reach * std
    return Change(of, before, after, after * std, words.unit_of(of), (after - wide, after + wide), chance)


def _pose(evidence: RobotSides) -> FoundEffect:
    covariance = evidence.sides.before_covariance + evidence.sides.off_covariance
    after = {name: float(evidence.sides.after[MOVABLE.index(name)]) for name in POSE_OFFSET.units}
    stds = {name: float(np.sqrt(covariance[n, n])) for n, name in enumerate(MOVABLE) if n in _OFFSET}
    told_names = [MOVABLE[place] for place in evidence.told]
    reach = _reach(evidence.after.fitted.clusters)
    return pose_effect({name: (after[name], stds[name]) for name in after if name in told_names}, reach)


def _effects(evidence: RobotSides, changes: tuple[Change, ...]) -> tuple[FoundEffect, ...]:
    """Those that are new after."""
    found = []
    for change in changes:
        if change.before is not None:
            continue
        if change.of == POSE_OFFSET.id:
            found.append(_pose(evidence))
        elif change.of == WHEEL_SLIP.id:
            found.append(slip_effect(evidence.after.found.slips))
        elif evidence.body is not None:
            found.append(evidence.body.effect(change.of))
    return tuple(found)


def _shared(evidence: RobotSides) -> dict[str, Moved]:
    """Wheels and track that both sides have alike, from where they were given."""
    found = {}
    for place in (place for place in evidence.told if place not in _OFFSET):
        name = MOVABLE[place]
        if name in evidence.weighed.best:
            continue
        std = float(np.sqrt(evidence.sides.before_covariance[place, place]))
        came = float(getattr(evidence.drive.geometry, name))
        found[name] = Moved(came, float(evidence.sides.before[place]), std, "m")
    return found


def _plant(evidence: RobotSides) -> DifferentialDrive:
    """The robot after."""
    drive, body = evidence.drive, evidence.body
    dynamics = drive.dynamics
    if body is not None:
        values = values_at(powered_robot(drive).values, body.sides.after)
        dynamics = dynamics_config(drive, values)
    return DifferentialDrive(
        drive.left, drive.right, geometry_of(evidence.sides.after), dynamics, drive.effects
    )


def _reach(clusters: int) -> float:
    return float(stdtrit(max(clusters - 1, 2), 0.975))
