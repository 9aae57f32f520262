"""In which unit a column is: what its name states, else what its values suggest."""

from __future__ import annotations

import re

import numpy as np

from nxt_twin.recording.checks import held_commands
from nxt_twin.recording.column_words import INPUTS, OUTPUTS
from nxt_twin.recording.guess.profile import CLOCK, ISO, TableColumn
from nxt_twin.recording.guess.roles import is_goal, is_pulse
from nxt_twin.recording.guess.vocabulary import has, quantity_and_unit
from nxt_twin.recording.steps import smallest_step

UnitScale = tuple[str, str, float, str]
"""Role, unit, size of one, and why."""

_EPOCHS = ((1e17, "ns"), (1e14, "us"), (1e11, "ms"), (1e8, "s"))
_LARGEST_RAD = 4.0 * np.pi
_FULL_SCALES = (
    (1.05, 1.0),
    (100.0, 100.0),
    (255.0, 255.0),
    (885.0, 885.0),
    (1023.0, 1023.0),
    (4095.0, 4095.0),
    (65535.0, 65535.0),
)
_ENCODERS = (
    (1023.0, 300.0 / 1024.0, "1024 steps in 300 degrees"),
    (4095.0, 360.0 / 4096.0, "4096 steps a turn"),
)
_ROS_ANGLE = re.compile(r".+\..+\.position$|joint_states?\b.*\bposition|field\.position\d*$")
_ROBOT_WORDS = ("q", "qm")
_FASTEST_RAD_PER_S = 40.0
_COARSE_RAD = 0.02
_SPELL_S = 0.1
_SPELLS = 3.0
TO_SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
_LOW_VOLTS = (1.05, 30.0)
_PULSE_DEG_PER_US, _PULSE_MIDDLE_US = 0.09, 1500.0
_FEWEST_LEAPS = 5
_SLOPE_OFF = 0.2
_ALIKE = 0.95
_TURNS = (360.0, 1024.0, 2.0 * float(np.pi), 4096.0, 16384.0, 65536.0)


def time_unit(column: TableColumn) -> tuple[str, str]:
    """The unit of stamps, and why."""
    measures, unit = quantity_and_unit(column)
    if column.stated_unit in (ISO, CLOCK):
        return (
            column.stated_unit,
            "dates that grow throughout" if column.stated_unit == ISO else "times of day",
        )
    if measures == "time":
        return unit, f"grows throughout; its name or unit says {unit}"
    for least, epoch in _EPOCHS:
        if column.largest > least:
            return epoch, f"grows throughout, from about {column.largest:.3g}: {epoch} since 1970"
    steps = np.diff(column.known)
    middle = float(np.median(steps[steps > 0.0]))
    told = f"grows throughout, by {middle:.3g} from row to row"
    if middle < 1.0 or not column.is_whole:
        return ("s", told) if middle < 1.0 else ("ms", f"{told}; CHECK")
    if middle < 1000.0:
        return "ms", f"{told} in whole numbers; CHECK"
    return ("us" if middle < 1e6 else "ns"), f"{told} in whole numbers; CHECK"


def output_scale(column: TableColumn, time: TableColumn | None = None) -> UnitScale:
    """The guess of a reading's kind and unit; stamps tell how fast it moves, where nothing states the unit."""
    measures, unit = quantity_and_unit(column)
    if measures in OUTPUTS:
        return measures, unit, 1.0, f"its name or unit says {unit}"
    if has(column, "speed"):
        return "speed", "rad/s", 1.0, "named like a speed; CHECK the unit, rad/s is assumed"
    if measures == "ticks" or (column.is_whole and has(column, "raw")):
        return _ticks(column)
    if _ROS_ANGLE.search(column.name):
        return "angle", "rad", 1.0, "named as in a JointState, which is in rad; a slider is position_m"
    if set(_ROBOT_WORDS) & set(column.words) and not column.is_whole:
        return "angle", "rad", 1.0, "no unit is stated; q is in rad where robots are taught; CHECK"
    if column.is_whole and column.span > _LARGEST_RAD:
        return "angle", "deg", 1.0, "whole numbers, taken for degrees; CHECK"
    pace = _pace_per_s(column, time)
    if pace and not column.is_whole and pace <= _FASTEST_RAD_PER_S and step_of(column) < _COARSE_RAD:
        told = f"no unit is stated; moves by up to {pace:.3g} a second, which would be slow in degrees: taken for rad"
        return "angle", "rad", 1.0, f"{told}; CHECK (a distance is position_m)"
    if column.largest <= _LARGEST_RAD:
        return (
            "angle",
            "rad",
            1.0,
            f"no unit is stated; up to {column.largest:.3g}, taken for rad; CHECK (a distance is position_m)",
        )
    return "angle", "deg", 1.0, f"no unit is stated; up to {column.largest:.4g}, taken for degrees; CHECK"


def _pace_per_s(column: TableColumn, time: TableColumn | None) -> float:
    """How fast a reading moves in its quickest tenths of a second; 0 where no stamps tell it."""
    if time is None:
        return 0.0
    unit, _ = time_unit(time)
    known = np.isfinite(column.values) & np.isfinite(time.values)
    moment, values = time.values[known] * TO_SECONDS.get(unit, 1.0), column.values[known]
    steps = np.diff(moment)
    if not np.any(steps > 0.0):
        return 0.0
    rows = max(round(_SPELL_S / float(np.median(steps[steps > 0.0]))), 1)
    elapsed = moment[rows:] - moment[:-rows]
    whole = (elapsed > 0.0) & (elapsed < _SPELLS * max(_SPELL_S, float(np.median(steps[steps > 0.0]))))
    paces = np.abs(values[rows:] - values[:-rows])[whole] / elapsed[whole]
    return float(np.quantile(paces, 0.99)) if paces.size else 0.0


def _ticks(column: TableColumn) -> UnitScale:
    for most, step_deg, told in _ENCODERS:
        if column.known.min() >= 0.0 and column.largest <= most:
            return (
                "angle",
                "deg",
                step_deg,
                f"ticks from 0 to {column.largest:g}, taken for {told}; CHECK the gain",
            )
    return "angle", "deg", 1.0, "ticks, taken for one degree each; CHECK the gain: degrees in a tick"


def input_scale(column: TableColumn, output: TableColumn, time: TableColumn | None = None) -> UnitScale:
    """The guess of a command's kind and unit."""
    return _goal_scale(column, output, time) or _drive_scale(column)


def _goal_scale(column: TableColumn, output: TableColumn, time: TableColumn | None) -> UnitScale | None:
    """That of a goal; None where the command is none."""
    measures, unit = quantity_and_unit(column)
    if is_pulse(column):
        why = "pulses of a hobby servo, 1500 us in the middle; CHECK gain and offset"
        return "goal", "deg", _PULSE_DEG_PER_US, why
    role, own, size, _ = output_scale(output, time)
    if is_goal(column) or (split_action(column) and not measures):
        if measures == "angle":
            return "goal", unit, 1.0, f"named like a goal, in {unit}"
        if role == "angle":
            return "goal", own, size, "named like a goal, in the unit of the reading"
    if measures not in INPUTS and role == "angle" and is_followed(column, output):
        return "goal", own, size, "the reading comes to where it says, so it is a goal; CHECK"
    return None


def _drive_scale(column: TableColumn) -> UnitScale:
    """That of a command that drives the motor by itself."""
    measures, unit = quantity_and_unit(column)
    if measures in INPUTS:
        return measures, unit, 1.0, f"its name or unit says {unit}"
    few, most_volts = _LOW_VOLTS
    is_letter = set(column.words) <= {"u"}  # a voltage in German, any command in control
    is_share = is_letter and not few < column.largest <= most_volts
    for role in ("voltage", "current", "torque", "force"):
        if has(column, role) and not is_share:
            first = next(iter(INPUTS[role]))
            return role, first, 1.0, f"named like a {role}; CHECK the unit, {first} is assumed"
    left = "what is left beside time and reading"
    if not has(column, "power") and few < column.largest <= most_volts:
        why = f"{left}, up to {column.largest:.3g}: taken for V, as so few percent would hardly turn a motor; CHECK"
        return "voltage", "V", 1.0, why
    named = "named like a power" if has(column, "power") else f"{left}, taken for a power"
    for most, full in _FULL_SCALES:
        if column.largest <= most:
            told = "in percent" if full == 100.0 else f"full at {full:g}"
            return "power", "pct", 100.0 / full, f"{named}, up to {column.largest:.4g}: {told}; CHECK"
    why = f"{named}, full at its largest value, {column.largest:g}; CHECK"
    return "power", "pct", 100.0 / column.largest, why


def duty_scale(column: TableColumn, largest: float) -> tuple[float, str]:
    """Percent in one of a duty's column, and why; of several motors' columns `largest` is the largest value."""
    measures, unit = quantity_and_unit(column)
    if measures == "power":
        return 1.0, f"its name or unit says {unit}"
    for most, full in _FULL_SCALES:
        if largest <= most:
            told = "in percent" if full == 100.0 else f"full at {full:g}"
            return 100.0 / full, f"named like a power, up to {largest:.4g}: {told}; CHECK"
    return 100.0 / largest, f"named like a power, full at its largest value, {largest:g}; CHECK"


def is_followed(command: TableColumn, reading: TableColumn) -> bool:
    """Whether the reading, before each leap of the command, is where the command says."""
    at, there = (held_commands(each.values, float(each.known[0])) for each in (command, reading))
    leaps = np.flatnonzero(np.diff(at) != 0.0)
    if leaps.size < _FEWEST_LEAPS or np.ptp(at[leaps]) == 0.0 or np.ptp(there[leaps]) == 0.0:
        return False
    slope, _ = np.polyfit(at[leaps], there[leaps], 1)
    alike = np.corrcoef(at[leaps], there[leaps])[0, 1]
    return bool(abs(slope - 1.0) < _SLOPE_OFF and alike > _ALIKE)


def pulse_line(command: TableColumn, reading: TableColumn, deg: float) -> tuple[float, float]:
    """By which gain and offset a hobby servo's pulses, us, are angles in degrees.

    Args:
        command: the pulses.
        reading: where the servo is.
        deg: degrees in one of the reading; 0 where it is no angle.
    """
    at, there = (held_commands(each.values, float(each.known[0])) for each in (command, reading))
    leaps = np.flatnonzero(np.diff(at) != 0.0)
    if deg and leaps.size >= _FEWEST_LEAPS and np.ptp(at[leaps]) > 0.0 and np.ptp(there[leaps]) > 0.0:
        slope, offset = np.polyfit(at[leaps], deg * there[leaps], 1)
        if abs(np.corrcoef(at[leaps], there[leaps])[0, 1]) > _ALIKE:
            return float(slope), float(offset)
    return _PULSE_DEG_PER_US, -_PULSE_DEG_PER_US * _PULSE_MIDDLE_US


def split_action(column: TableColumn) -> bool:
    """LeRobot's `action` is the goal of each joint."""
    return "action" in column.words


def turn_length(column: TableColumn) -> float:
    """At which value a reading starts anew, in the column's unit; 0 where it does not."""
    leaps = np.abs(np.diff(column.known))
    for turn in _TURNS:
        if 0.9 * turn < column.span < 1.01 * turn and leaps.max(initial=0.0) > 0.75 * turn:
            return turn
    return 0.0


def step_of(column: TableColumn) -> float:
    """The smallest step of a reading, in the column's unit; 0 where it has none that shows."""
    return smallest_step(column.known)
