"""The sentences of a robot's diagnosis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from nxt_twin.diagnose.diagnosis import Fit, FoundEffect, NextExperiment, Verdict
from nxt_twin.diagnose.robot.effects import LIBRARY
from nxt_twin.diagnose.robot.held_out import JudgedRun, horizons_of
from nxt_twin.diagnose.robot.leftover import RobotLeft
from nxt_twin.diagnose.robot.runs import RobotRun
from nxt_twin.diagnose.robot.slip import SlipSpell
from nxt_twin.diagnose.robot.spread import SessionSpread
from nxt_twin.diagnose.robot.tellable import tellable
from nxt_twin.diagnose.telling.words import listed
from nxt_twin.physics.robot.drive import Geometry
from nxt_twin.recording.robot_path import squares_and_lines

_ONE_WAY: Final = 0.1  # share that the turns to one side must have of those to the other to tell the track
_HARDLY_TURNS_RAD: Final = 2.0  # turning in all below which the track does not show
_MOST_NAMED: Final = 4  # runs or spells that a note tells one by one
ONE_FACTOR: Final = 0.1
"""Radius and track that moved alike but for such a share are off by one factor (cameras 3 % too wide: 0.04, 0.06)."""
_SQUARES: Final = (
    "drive a square of 1 m five times to the left and five times to the right, with 2 s of rest at each corner. "
    "Then drive 2 m straight forward and back at two headings"
)
_BY: Final = {
    "mean_wheel_radius_m": ("mean wheel radius", 1e3, "mm"),
    "wheel_radius_ratio": ("ratio of the wheels", 1.0, ""),
    "track_m": ("track", 1e3, "mm"),
    "heading_offset_deg": ("heading offset", 1.0, "°"),
}


def impossible(is_possible: bool, given: Geometry, fitted: Geometry) -> tuple[str, ...]:
    """A line on wheels and a track that cannot be the robot's; none where they can."""
    if is_possible:
        return ()
    radius = fitted.mean_wheel_radius_m / given.mean_wheel_radius_m
    return (
        f"The pose would need wheels of {1e3 * fitted.mean_wheel_radius_m:.3g} mm, {radius:.2g} times those given, and "
        f"a track of {1e3 * fitted.track_m:.3g} mm. Check units, gains and signs of the wheels' columns and the pose, "
        "and which wheel is left.",
    )


def scale_words(effects: Sequence[FoundEffect], given: Geometry, fitted: Geometry) -> tuple[str, ...]:
    """A line where a camera of another scale would do what the named radius and track do; else none."""
    if not {"wheel_radius", "wrong_track"} <= {effect.id for effect in effects}:
        return ()
    radius = fitted.mean_wheel_radius_m / given.mean_wheel_radius_m - 1.0
    track = fitted.track_m / given.track_m - 1.0
    if abs(radius - track) > ONE_FACTOR * abs(radius):
        return ()
    return (
        f"Radius and track are both off by {100.0 * radius:+.2g} %. A camera whose scale is off as much "
        "does just that: measure a known length with it.",
    )


def sentence(verdict: Verdict, effects: Sequence[FoundEffect], fit: Fit) -> str:
    """The verdict with its figures, in one sentence."""
    unseen = "over whole held-out runs"
    if verdict == "adequate":
        reached = f"{fit.improved:.3g} mm {unseen}"
        return (
            f"Nothing is missing: from the wheel angles alone, the model predicts the position to {reached}."
        )
    if not effects:
        left = f"the position error is {fit.improved:.3g} mm {unseen}"
        return f"Something is missing, and no known effect accounts for it; {left}."
    named = listed([effect.name for effect in effects])
    given = next((one.given for one in fit.horizons if one.seconds is None), fit.baseline)
    falls = max(given, fit.baseline) > 1.02 * fit.improved
    before = f"{fit.baseline:.3g} mm re-fitted"
    if given > 1.02 * fit.baseline:
        before = f"{given:.3g} mm as given and {before}"
    gain = f"from {before} to {fit.improved:.3g} mm {unseen}"
    told = (
        f"the position error falls {gain}"
        if falls
        else f"the position error stays at {fit.improved:.3g} mm {unseen}"
    )
    if verdict == "explained":
        return f"The model leaves out {named}; with {'these' if len(effects) > 1 else 'it'} in, {told}."
    return f"Something is missing, and no known effect accounts for all of it; with {named} in, {told}."


def below_tolerance(small: Mapping[str, float], tolerance_m: float | None) -> str:
    """A sentence about effects that show and do not matter, by how far they move paths (m); empty without any."""
    if not small or tolerance_m is None:
        return ""
    named = [f"{LIBRARY[one].name} ({1e3 * far:.2g} mm)" for one, far in small.items()]
    whole = listed(named)
    return (
        f" {whole[0].upper()}{whole[1:]} {'moves' if len(named) == 1 else 'move'} the path by less than "
        f"the tolerance of {1e3 * tolerance_m:.3g} mm."
    )


def notes(
    judged: Sequence[JudgedRun],
    spread: dict[str, SessionSpread],
    slips: Sequence[SlipSpell],
    left: RobotLeft | None,
    runs: Sequence[RobotRun],
) -> tuple[str, ...]:
    """Plain remarks: runs that stay bad, sessions that disagree, slip, what is left, what cannot be told."""
    return (
        *_bad_runs(judged),
        *_disagreements(spread),
        *slip_words(slips),
        *leftover_words(left),
        *untold_words(runs),
    )


def _bad_runs(judged: Sequence[JudgedRun]) -> list[str]:
    mean = np.mean([np.mean(one.errors[2].whole) for one in judged])
    bad = [one for one in judged if one.runs_out and np.mean(one.errors[2].whole) > mean]
    if not bad:
        return []
    said = [
        f"{one.run.name} keeps a large error: its own clock is off by up to {one.own_lag_s:.2f} s."
        for one in bad[:_MOST_NAMED]
    ]
    if len(bad) > _MOST_NAMED:
        said.append(f"The clocks of {len(bad) - _MOST_NAMED} more runs are off too.")
    rest = [one for one in judged if one not in bad]
    if rest:
        each = [
            f"{one.improved:.3g} mm "
            + (
                "over whole runs"
                if one.seconds is None
                else f"after {one.metres or one.seconds:g} {'m' if one.metres else 's'}"
            )
            for one in horizons_of(rest)
        ]
        said.append(
            f"Without {'this run' if len(bad) == 1 else 'these runs'} the improved model errs by {listed(each)}."
        )
    return said


def _disagreements(spread: dict[str, SessionSpread]) -> list[str]:
    said = []
    for name, told in spread.items():
        if told.between <= 0.0 or name not in _BY:
            continue
        words, factor, unit = _BY[name]
        low, high = (factor * pick(told.values.values()) for pick in (min, max))
        said.append(
            f"The {words} differs between paths or sessions by more than its uncertainty: {low:.5g} to {high:.5g}"
            f"{unit and ' '}{unit}. Its 95 % interval includes this spread."
        )
    return said


def slip_words(slips: Sequence[SlipSpell]) -> list[str]:
    """Where wheels slip, the strongest spells first."""
    said = [
        f"The {slip.side} wheel slips in {slip.recording} from {slip.start_s:.1f} to {slip.end_s:.1f} s: it loses "
        f"{100 * slip.ratio:.0f} % of its travel."
        for slip in slips[:_MOST_NAMED]
    ]
    if len(slips) > _MOST_NAMED:
        said.append(f"Wheels also slip in {len(slips) - _MOST_NAMED} more spells.")
    if slips:
        said.append("The wheel angles do not show slip, so the model cannot predict it.")
    if any(slip.lost is not None for slip in slips):
        said.append("Tyres slip at hard starts and stops. The errors are those of paths without this slip.")
    return said


def leftover_words(left: RobotLeft | None) -> list[str]:
    """Where the residual is largest, if one is more than noise."""
    if left is None:
        return []
    if left.channel == "wheels":
        return [
            "The motor powers do not explain the wheels' motion: a force is missing, and no known effect has it."
        ]
    channel = {"along": "travel", "sideways": "sideways position", "turn": "turn"}[left.channel]
    return [
        f"The residual is largest in the {channel}: {100 * left.size:.0f} % of it goes with the {left.along}."
    ]


def untold_words(runs: Sequence[RobotRun]) -> list[str]:
    """What these paths leave open."""
    if not tellable(runs).all():
        return [
            "The robot turns on the spot and hardly travels. These paths show only the ratio of wheel radius to "
            "track: not the radius itself, not unequal wheels, and not the heading of the markers."
        ]
    turns = np.concatenate([np.diff(run.pose.heading_rad[:: max(1, run.time_s.size // 200)]) for run in runs])
    to_left, to_right = float(np.sum(turns[turns > 0.0])), float(-np.sum(turns[turns < 0.0]))
    if to_left + to_right < _HARDLY_TURNS_RAD:
        return ["The robot hardly turns, so these paths do not show the track."]
    if min(to_left, to_right) < _ONE_WAY * max(to_left, to_right):
        return ["The robot turns only one way, so these paths do not tell unequal wheels from a wrong track."]
    return []


def why_confusable(effect: str, other: str) -> str:
    """Why these recordings leave it open which of two effects it is."""
    told = LIBRARY[effect].confusable_with.get(other) or LIBRARY[other].confusable_with.get(effect)
    said = "either effect fits these paths nearly as well"
    return f"{said}; {told}" if told else said


def next_path(
    effects: Sequence[FoundEffect], verdict: Verdict, left: RobotLeft | None, runs: Sequence[RobotRun]
) -> NextExperiment | None:
    """The path to drive next."""
    confused = [(effect.key, other.id) for effect in effects for other in effect.confusable_with]
    if confused:
        one, other = confused[0]
        return _squares(f"these paths do not tell {LIBRARY[one].name} from {LIBRARY[other].name}")
    if verdict == "unexplained":
        why = (
            f"the residual goes with the {left.along}, and no known effect does"
            if left
            else "a residual remains, and no known effect explains it"
        )
        return _squares(why, " Repeat this at another speed and at another place on the floor")
    if open_questions := untold_words(runs):
        return _squares(open_questions[0].rstrip("."))
    return None


def _squares(why: str, more: str = "") -> NextExperiment:
    words = f"{_SQUARES}.{more}" if more else _SQUARES
    return NextExperiment(why=why, input=words, path=squares_and_lines(why))
