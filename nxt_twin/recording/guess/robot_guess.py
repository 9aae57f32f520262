"""The mapping of a robot's table, guessed: each key with the reason for it."""

from __future__ import annotations

from collections.abc import Iterator
from math import tau
from typing import Any, Final, NamedTuple

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import MappingError
from nxt_twin.recording.guess.found import Guess
from nxt_twin.recording.guess.profile import TableColumn, TableProfile
from nxt_twin.recording.guess.robot import RobotColumns, holds_quaternion
from nxt_twin.recording.guess.robot_frame import UNITS_RAD, RobotFrame, frame_of
from nxt_twin.recording.guess.roles import names
from nxt_twin.recording.guess.scales import duty_scale
from nxt_twin.recording.guess.vocabulary import quantity_and_unit
from nxt_twin.recording.robot_mapping import METRES, LengthUnit

_LARGEST_M: Final = 15.0  # of a place that states no unit: robots of a classroom stay nearer to its origin
_TWO_TURNS_RAD: Final = 1.02 * tau
_RADII_M: Final = (0.01, 0.3)  # of a robot's wheels
_NEEDS: Final = {
    "pose_x": "mm", "pose_y": "mm", "pose_heading": "deg", "left_angle": "deg", "right_angle": "deg",
}  # fmt: skip
_FLIPPED: Final = (
    "the wheels turn the other way round: y points to the right, or left and right are interchanged; CHECK"
)


class _Scale(NamedTuple):
    unit: LengthUnit
    why: str


def robot_guesses(profile: TableProfile, columns: RobotColumns) -> tuple[list[Guess], MappingError | None]:
    """The keys of pose, wheels and powers, and why they are no whole mapping where one is lacking."""
    roles = {
        "pose_x": columns.x,
        "pose_y": columns.y,
        "pose_heading": columns.heading,
        "left_angle": columns.left,
        "right_angle": columns.right,
    }
    lacking = next((key for key, column in roles.items() if column is None), None)
    if lacking is not None:
        return [], _lacks(profile, lacking, [each for each in roles.values() if each is not None])
    x, y, heading, left, right = (each for each in roles.values() if each is not None)
    found = [*_pose(x, y, heading, left, right)]
    found += _powers(columns)
    return found, None


def _lacks(profile: TableProfile, key: str, taken: list[TableColumn]) -> MappingError:
    """The refusal of a table that lacks one of a robot's columns."""
    rest = [column for column in profile.columns if all(column is not each for each in taken)]
    mend = (
        f"write `{key}: {{column: …, unit: {_NEEDS[key]}}}` in a mapping; its other columns are {names(rest)}"
    )
    if key == "pose_heading" and holds_quaternion(profile.columns):
        mend = f"add a column of the yaw, 2·atan2(z, w) of the quaternion, and {mend}"
    what = f"looks like a robot's table, but has no column that looks like its {key}"
    return MappingError(what, where=str(profile.path), mend=mend)


def _pose(
    x: TableColumn, y: TableColumn, heading: TableColumn, left: TableColumn, right: TableColumn
) -> Iterator[Guess]:
    place = _place_scale(x, y)
    units = _heading_units(heading)
    frame = frame_of((x.values, y.values), heading.values, (left.values, right.values), units)
    flipped = frame is not None and frame.mirrored
    sign = _sign_of(-1.0 if flipped else 1.0)
    yield Guess("pose_x", x.keys | {"unit": place.unit}, place.why)
    yield Guess(
        "pose_y", y.keys | {"unit": place.unit} | sign, f"{place.why}{'; ' + _FLIPPED if flipped else ''}"
    )
    yield _heading(heading, units, frame)
    for key, column, factor in (
        ("left_angle", left, frame.left if frame else 1.0),
        ("right_angle", right, frame.right if frame else 1.0),
    ):
        yield _wheel(key, column, factor, frame, place.unit)


def _heading(heading: TableColumn, units: tuple[str, ...], frame: RobotFrame | None) -> Guess:
    measures, stated = quantity_and_unit(heading)
    unit = frame.unit if frame else units[0]
    turns = frame.turns * (-1.0 if frame.mirrored else 1.0) if frame else 1.0
    if measures:
        why = f"its name or unit says {stated}"
    elif frame is not None and frame.is_clear:
        why = f"turns as its path does in {unit}; CHECK"
    else:
        why = f"no unit is stated; up to {heading.largest:.4g}, taken for {unit}; CHECK"
    if turns < 0.0:
        why += "; grows clockwise, as path and wheels tell; CHECK"
    return Guess("pose_heading", heading.keys | {"unit": unit} | _sign_of(turns), why)


def _wheel(
    key: str, column: TableColumn, factor: float, frame: RobotFrame | None, place: LengthUnit
) -> Guess:
    measures, stated = quantity_and_unit(column)
    told = f"; the robot travels {frame.step:.3g} {place} for each 1 of it" if frame else ""
    sign = _sign_of(factor)
    if factor < 0.0:
        told += "; falls as the robot drives on; CHECK"
    if measures == "angle":
        return Guess(key, column.keys | {"unit": stated} | sign, f"its name or unit says {stated}{told}")
    counts = measures == "ticks" or column.is_whole
    radius_m = frame.step * METRES[place] if frame else 0.0
    if not counts and _RADII_M[0] <= radius_m <= _RADII_M[1]:
        told = f"no unit is stated; in rad its wheels would have a radius of {1e3 * radius_m:.3g} mm; CHECK"
        return Guess(key, column.keys | {"unit": "rad"} | sign, told)
    what = "ticks, taken for one degree each" if counts else "no unit is stated, taken for degrees"
    why = f"{what}; CHECK the gain: degrees in 1 of it{told}"
    return Guess(key, column.keys | {"unit": "deg", "gain": factor}, why)


def _powers(columns: RobotColumns) -> Iterator[Guess]:
    both = [each for each in (columns.left_power, columns.right_power) if each is not None]
    largest = max((each.largest for each in both), default=0.0)
    for key, column in zip(("left_power", "right_power"), both, strict=False):
        gain, why = duty_scale(column, largest)
        yield Guess(key, column.keys | ({"gain": float(f"{gain:.6g}")} if gain != 1.0 else {}), why)


def _place_scale(x: TableColumn, y: TableColumn) -> _Scale:
    stated = (quantity_and_unit(column) for column in (x, y))
    named = next((unit for measures, unit in stated if measures == "position"), "")
    for known in METRES:
        if known == named:
            return _Scale(known, f"its name or unit says {known}")
    largest = max(x.largest, y.largest)
    unit: LengthUnit = "m" if largest <= _LARGEST_M else "mm"
    return _Scale(unit, f"no unit is stated; up to {largest:.4g}, taken for {unit}; CHECK")


def _heading_units(heading: TableColumn) -> tuple[str, ...]:
    """The units that a heading may have, the likeliest first."""
    measures, unit = quantity_and_unit(heading)
    if measures == "angle" and unit in UNITS_RAD:
        return (unit,)
    return ("rad", "deg") if _moves_within_a_turn(heading.known) else ("deg", "rad")


def _moves_within_a_turn(values: FloatArray) -> bool:
    return bool(values.size) and float(abs(values).max()) <= _TWO_TURNS_RAD


def _sign_of(factor: float) -> dict[str, Any]:
    return {"gain": -1.0} if factor < 0.0 else {}
