"""From a robot's case to a diagnosis: re-fit wheels and track, find what is missing, judge by simulated paths."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from nxt_twin.diagnose.diagnosis import Alternative, Diagnosis, Fit, Mismatch, Tolerance, Verdict
from nxt_twin.diagnose.progress import Progress
from nxt_twin.diagnose.robot import words
from nxt_twin.diagnose.robot.choice import places_of
from nxt_twin.diagnose.robot.effects import LIBRARY
from nxt_twin.diagnose.robot.findings import found_effects, moved_parameters, sizes_seen
from nxt_twin.diagnose.robot.fit import fit_windows
from nxt_twin.diagnose.robot.goes_on import what_goes_on
from nxt_twin.diagnose.robot.held_out import (
    FEWEST_RUNS,
    JudgedRun,
    cut,
    drawn_runs,
    horizons_of,
    judge_held_out,
    model_of,
)
from nxt_twin.diagnose.robot.judge import MM, errors_of, figures
from nxt_twin.diagnose.robot.leftover import (
    RobotLeft,
    ShortErrors,
    regimes_of,
    scale_of,
    short_errors,
    spells_of,
    what_is_left,
)
from nxt_twin.diagnose.robot.powered_search import PoweredFindings, search_powered
from nxt_twin.diagnose.robot.runs import RobotRun, has_powers, robot_runs
from nxt_twin.diagnose.robot.search import RobotFindings, mend, search, start_of, wheels_at
from nxt_twin.diagnose.robot.stack import stacked
from nxt_twin.diagnose.robot.tellable import tellable
from nxt_twin.diagnose.robot.tolerated import path_shifts
from nxt_twin.errors import DiagnosisError
from nxt_twin.physics.robot.drive import DifferentialDrive, Geometry, drive_from_config
from nxt_twin.physics.robot.powered import body_effects, dynamics_config, is_powered
from nxt_twin.recording.case import ROBOT_KIND, Case
from nxt_twin.recording.configs import load_plant_config

_PARTS: Final = 4  # into which each run is cut where there are fewer than three runs
_FARTHEST: Final = 3.0
"""No wear and no mistaken part makes a wheel three times as large; a column's unit, gain or sign does."""
_METRIC: Final = "position RMSE over whole runs from the wheels and the first pose, held-out"


@final
@dataclass(frozen=True)
class RobotAnswer:
    """A diagnosis, and the improved robot that belongs to it."""

    diagnosis: Diagnosis
    model: DifferentialDrive


@final
@dataclass(frozen=True)
class _RobotEvidence:
    """Everything that a robot's diagnosis is put together from."""

    case: Case
    drive: DifferentialDrive
    found: RobotFindings
    judged: tuple[JudgedRun, ...]
    left: tuple[RobotLeft, ...]
    goes_on: tuple[RobotLeft, ...]
    short: ShortErrors
    powered: PoweredFindings | None
    tolerance_m: float | None

    @property
    def is_possible(self) -> bool:
        """Whether the fitted wheels and track are a robot's, and near enough the given ones to be theirs."""
        fitted, given = self.found.final.state.as_geometry, self.drive.geometry
        ratios = (
            fitted.left_wheel_radius_m / given.left_wheel_radius_m,
            fitted.right_wheel_radius_m / given.right_wheel_radius_m,
            fitted.track_m / given.track_m,
        )
        return all(1.0 / _FARTHEST < ratio < _FARTHEST for ratio in ratios)

    @property
    def structured(self) -> RobotLeft | None:
        """The most that is left and is more than noise."""
        kept = [one for one in self.left if one.is_structured]
        if kept:
            return max(kept, key=lambda one: one.size * one.nats)
        if self.goes_on:
            return self.goes_on[0]
        return self.powered.left if self.powered else None


def is_robot_case(case: Case) -> bool:
    """Whether a case is about a robot on two wheels."""
    config = load_plant_config(case.plant) if isinstance(case.plant, str) else case.plant
    return config.get("kind") == ROBOT_KIND


def robot_of(case: Case) -> DifferentialDrive:
    """The robot of a case, as its model came.

    Raises:
        PlantError: a key or value that is none.
    """
    return drive_from_config(load_plant_config(case.plant) if isinstance(case.plant, str) else case.plant)


def diagnose_robot(
    case: Case, *, tolerance_m: float | None = None, progress: Progress = lambda _: None
) -> RobotAnswer:
    """Say what a robot's model leaves out, if anything.

    Args:
        case: a case about a robot whose pose was measured from outside.
        tolerance_m: an error of the position over whole runs that does not matter; None: what shows is named.
        progress: told in words what is being done.

    Raises:
        DiagnosisError: wheels or pose are missing, or the robot does not drive.
        PlantError: a key or value of the model that is none.
    """
    drive = robot_of(case)
    runs, held = robot_runs(case.recordings, drive), robot_runs(case.holdout, drive)
    if len(runs) < FEWEST_RUNS:
        runs = tuple(part for run in runs for part in cut(run, _PARTS))
    found = search(runs, drive.geometry, progress)
    powered = None
    if is_powered(drive) and has_powers(case.recordings, drive):
        progress("fitting motors and body")
        held_powers = case.holdout if has_powers(case.holdout, drive) else ()
        geometry = found.final.state.as_geometry
        powered = search_powered(case.recordings, held_powers, drive, geometry, found.slips)
    progress("judging on what was held out")
    judged = tuple(judge_held_out(runs, held, drive.geometry, found))
    stack = stacked(mend(runs, found.slips))
    after = short_errors(stack.runs, found.final.state.as_geometry, wheels_at(stack, found.final.state))
    plain = stacked(runs)
    before = short_errors(
        runs, drive.geometry, wheels_at(plain, start_of(drive.geometry, len(runs))), scale_of(after)
    )
    evidence = _RobotEvidence(
        case,
        drive,
        found,
        judged,
        tuple(what_is_left(after)),
        tuple(what_goes_on(after)),
        before,
        powered,
        tolerance_m,
    )
    diagnosis = _diagnosis(evidence)
    geometry = model_of(found.final).geometry if evidence.is_possible else drive.geometry
    named = {
        effect.id: {name: one.value for name, one in effect.params.items()}
        for effect in diagnosis.effects
        if effect.motor is None
    }
    if "clock_skew" in named:
        named["clock_skew"]["lag_s"] = model_of(found.final).lag_s
    dynamics = dynamics_config(drive, powered.values) if powered else drive.dynamics
    beside = {**drive.effects, **(body_effects(powered.values) if powered else {})}
    model = DifferentialDrive(drive.left, drive.right, geometry, dynamics, {**beside, **named})
    return RobotAnswer(diagnosis, model)


def fit_robot(case: Case) -> tuple[dict[str, Any], DifferentialDrive]:
    """Fit wheels, track and markers of a case's robot as it stands.

    Returns:
        Of each parameter its value, standard deviation and unit; and the fitted robot.

    Raises:
        DiagnosisError, PlantError: as `diagnose_robot`.
    """
    drive = robot_of(case)
    runs = robot_runs(case.recordings, drive)
    if not runs:
        raise DiagnosisError("lists no recording", where=case.name)
    fitted = fit_windows(stacked(runs), start_of(drive.geometry, len(runs)), tellable(runs), clock=False)
    model = DifferentialDrive(
        drive.left, drive.right, fitted.state.as_geometry, drive.dynamics, drive.effects
    )
    std = np.sqrt(np.diag(fitted.covariance))
    units = {name: unit for effect in LIBRARY.values() for name, unit in effect.units.items()}
    names = ("mean_wheel_radius_m", "wheel_radius_ratio", "track_m", "offset_forward_m", "offset_left_m")
    values = dict(
        zip((*names, "heading_offset_deg"), zip(fitted.state.geometry, std, strict=True), strict=True)
    )
    return {
        name: {"value": float(value), "std": float(doubt), "unit": units[name]}
        for name, (value, doubt) in values.items()
    }, model


def _diagnosis(evidence: _RobotEvidence) -> Diagnosis:
    found, judged = evidence.found, evidence.judged
    powered = evidence.powered
    small = path_shifts(found, evidence.drive.geometry).below(evidence.tolerance_m)
    named = [effect for effect in found_effects(found) if effect.id not in small]
    if not evidence.is_possible:
        named = []
    effects = (*named, *(powered.effects if powered else ()))
    horizons = horizons_of(judged)
    whole = horizons[-1]
    reached = evidence.tolerance_m is not None and whole.improved < MM * evidence.tolerance_m
    structured = None if reached else evidence.structured
    verdict: Verdict = (
        "unexplained" if structured or not evidence.is_possible else "explained" if effects else "adequate"
    )
    fit = Fit(_METRIC, "mm", whole.baseline, whole.improved, whole.floor, horizons)
    return Diagnosis(
        name=evidence.case.name,
        verdict=verdict,
        sentence=words.sentence(verdict, effects, fit) + words.below_tolerance(small, evidence.tolerance_m),
        refit=moved_parameters(found, evidence.drive.geometry) | (powered.moved if powered else {}),
        mismatch=_mismatch(evidence, verdict, [effect.key for effect in effects]),
        effects=effects,
        alternatives=_alternatives(evidence),
        fit=fit,
        next_experiment=words.next_path(effects, verdict, structured, found.runs),
        notes=(
            *words.impossible(evidence.is_possible, evidence.drive.geometry, found.final.state.as_geometry),
            *words.scale_words(effects, evidence.drive.geometry, found.final.state.as_geometry),
            *words.notes(judged, found.spread, found.slips, structured, found.runs),
            *(powered.notes if powered else ()),
        ),
        held_out=drawn_runs(judged),
        leftover=None,
        detectable=sizes_seen(found),
        tolerance=None
        if evidence.tolerance_m is None
        else Tolerance(MM * evidence.tolerance_m, "mm", whole.improved),
    )


def _mismatch(evidence: _RobotEvidence, verdict: Verdict, named: list[str]) -> Mismatch:
    """When and in which way of driving the model as given fails, by the noise of the improved one."""
    channel = "pose_heading_deg" if named == ["pose_offset"] else "pose_x_m"
    if verdict == "adequate":
        return Mismatch(channel, (), (), None)
    short = evidence.short
    equation = LIBRARY[named[0]].fails if named else "measurement"
    return Mismatch(channel, spells_of(short, evidence.found.runs), regimes_of(short), equation)


def _alternatives(evidence: _RobotEvidence) -> tuple[Alternative, ...]:
    """Effects of the geometry that were not named, with the held-out error that they would give."""
    found = evidence.found
    named = {effect.id for effect in found.choice.named}
    others = sorted(
        ((found.choice.probability[one], one) for one in found.choice.probability if one not in named),
        reverse=True,
    )
    return tuple(
        Alternative(one, chance, _error_with(evidence, one)) for chance, one in others[:2] if chance > 0.02
    )


def _error_with(evidence: _RobotEvidence, effect: str) -> float:
    found = evidence.found
    free = found.final.free.copy()
    free[places_of(LIBRARY[effect])] = True
    given: Geometry = evidence.drive.geometry
    stack = stacked(mend(found.runs, found.slips))
    model = model_of(fit_windows(stack, start_of(given, len(found.runs)), free, clock=found.final.clock))
    runs: list[RobotRun] = [one.run for one in evidence.judged]
    return figures([errors_of(model, run, given.mean_wheel_radius_m) for run in runs]).whole
