"""Which column is the time, the command, the reading, the supply: by name, unit and values."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, final

import numpy as np

from nxt_twin.recording.guess.motion import slopes_of
from nxt_twin.recording.guess.profile import TableColumn, TableProfile
from nxt_twin.recording.guess.vocabulary import has, quantity_and_unit
from nxt_twin.recording.tables.nested import split_name

_SLOPE = 2.5  # how much it speaks for a reading that another column is its slope
_COMMANDS = ("power", "voltage", "current", "torque", "force", "command", "goal")
_MOST_RUNS = 1000
_MODES = 4
_NO_GOALS = ("power", "voltage", "current", "torque", "speed")
_SIGNS = (-1, 0, 1)
_SUPPLY_V = (2.0, 100.0)
_NAMED_GROWTH = 0.05  # of the rows, in which a column that is named after time has to grow
_MOST_FALLS = 0.2
_MISSING = 0.1  # of the stamps of a column that is named after time; reading it tells in which rows
_LOW = 0.05  # of the span of stamps, within which a run begins
_WRAPS = (2.0**16, 2.0**32, 2.0**32 / 1e3, 1e6, 1e9)
_WHOLE = 0.9  # of such a counter's range, which it falls by
_PULSES_US = (400.0, 2600.0)


@final
@dataclass(frozen=True)
class Roles:
    """The columns by role; None where none is found.

    `modes` are those that say what the bridge does; `sign` is the direction of a command that has none;
    `slopes` names, by column, another one that is its slope.
    """

    time: TableColumn | None
    split: TableColumn | None
    output: TableColumn | None
    input: TableColumn | None
    supply: TableColumn | None
    modes: tuple[TableColumn, ...]
    sign: TableColumn | None
    slopes: Mapping[str, str]


def roles_of(profile: TableProfile, joint: str | None) -> Roles:
    """The likeliest column for each role, each column in one role.

    Args:
        profile: the table.
        joint: the name or index of the joint in question, where the table holds several; None takes the one that
            moves most.
    """
    left = [column for column in profile.columns if not has(column, "aside")]
    split = _take(left, _as_split)
    groups = _groups(split, profile.rows)
    time = _take(left, lambda column: _as_time(column, groups))
    slopes = slopes_of(left, time, groups)
    own = [column for column in left if is_of(column, joint)]
    output = _take(own, lambda column: _as_output(column) + _SLOPE * (column.name in slopes))
    left = [column for column in left if column is not output]
    given = [column for column in own if column is not output]
    command = _take(given, lambda column: _as_input(column, output)) if output else None
    left = [column for column in left if column is not command]
    supply = _take(left, _as_supply)
    unsigned = command is not None and command.known.min() >= 0.0
    sign = _take([*left, *profile.switches], lambda column: float(unsigned and is_sign(column)))
    left = [column for column in left if column is not sign]
    return Roles(time, split, output, command, supply, tuple(filter(_is_mode, left)), sign, slopes)


def _take(columns: list[TableColumn], rating: Callable[[TableColumn], float]) -> TableColumn | None:
    """The column that rates best above 0, taken out of the list; of equals the first."""
    rated = [(rating(column), -place) for place, column in enumerate(columns)]
    best, place = max(rated, default=(0.0, 0))
    return columns.pop(-place) if best > 0.0 else None


def is_of(column: TableColumn, joint: str | None) -> bool:
    """Whether a column is of the joint, by its index or a word of its name; any column where no joint is meant."""
    if joint is None or (column.index is None and not column.joint and joint.lower() not in column.words):
        return joint is None
    return joint == str(column.index) or joint.lower() in (column.joint.lower(), *column.words)


def _groups(split: TableColumn | None, rows: int) -> list[slice]:
    """The rows of each recording."""
    if split is None:
        return [slice(0, rows)]
    edges = [0, *(np.flatnonzero(np.diff(split.values)) + 1).tolist(), rows]
    return [slice(low, high) for low, high in pairwise(edges)]


def _as_split(column: TableColumn) -> float:
    if not has(column, "split") or not column.is_whole or not 1 < np.unique(column.known).size <= _MOST_RUNS:
        return 0.0
    return 1.0 if np.count_nonzero(np.diff(column.values)) < 0.2 * column.values.size else 0.0


def _as_time(column: TableColumn, groups: Sequence[slice]) -> float:
    steps = np.concatenate([np.diff(column.values[group]) for group in groups])
    steps = steps[np.isfinite(steps)]
    missing = np.mean(~np.isfinite(column.values))
    if (
        not steps.size
        or has(column, "angle")
        or missing > (_MISSING if has(column, "time") else 0.0)
        or np.mean(steps > 0.0) < (_NAMED_GROWTH if has(column, "time") else 0.5)
        or (np.any(steps < 0.0) and (len(groups) > 1 or disorder_of(column) is None))
    ):
        return 0.0
    steps = steps[steps >= 0.0]
    evenness = 1.0 - min(float(np.std(steps) / np.mean(steps)), 1.0) + 2.0 * bool(np.all(steps > 0.0))
    named = (
        5.0 * has(column, "time")
        + 3.0 * (quantity_and_unit(column)[0] == "time")
        - 4.0 * has(column, "counter")
    )
    return max(2.0 + named + evenness - 2.0 * _is_mere_count(column), 0.0)


Disorder = Literal["wraps", "runs", "sort"]
"""Why stamps fall: their counter starts anew, several runs lie in one table, or rows are out of order."""


def disorder_of(column: TableColumn) -> Disorder | None:
    """Why a column that is named after time falls here and there; None where it grows throughout, or is no time."""
    falls = np.flatnonzero(np.diff(column.values) < 0.0)
    if not falls.size or not has(column, "time") or falls.size > _MOST_FALLS * column.values.size:
        return None
    if wrap_of(column):
        return "wraps"
    low = column.known.min() + _LOW * column.span
    return "runs" if bool(np.all(column.values[falls + 1] <= low)) else "sort"


def wrap_of(column: TableColumn) -> float:
    """The value at which a board's counter of time starts anew; 0 where the column's falls are none of such."""
    falls = np.diff(column.known)
    falls = falls[falls < 0.0]
    fits = (
        wrap for wrap in _WRAPS if falls.size and column.largest < wrap and np.all(falls < -_WHOLE * wrap)
    )
    return next(fits, 0.0)


def _is_mere_count(column: TableColumn) -> bool:
    """Rows that are numbered."""
    return column.is_whole and bool(np.all(np.diff(column.values) == 1.0))


def _as_output(column: TableColumn) -> float:
    if (
        column.span == 0.0
        or is_goal(column)
        or is_pulse(column)
        or has(column, "split")
        or has(column, "supply")
    ):
        return 0.0
    measures, _ = quantity_and_unit(column)
    named = 5.0 * has(column, "angle") + 3.0 * has(column, "speed") - 2.0 * has(column, "derived")
    united = 4.0 * (measures in ("angle", "ticks", "position")) + 3.0 * (measures == "speed")
    other = 6.0 * (measures in ("time", "power", "voltage", "current", "torque", "force"))
    is_angle = has(column, "angle") or measures in ("angle", "ticks")
    other += 4.0 * any(has(column, each) for each in _COMMANDS[:-1]) * (not is_angle)
    other += 5.0 * (has(column, "counter") and _is_mere_count(column))
    smooth = float(np.mean(np.abs(np.diff(column.known))) < 0.1 * column.span)
    moving = 0.5 * column.span / (column.span + 100.0)
    return max(2.0 + named + united - other + smooth + moving - 1.5 * _is_stepped(column), 0.0)


def _is_stepped(column: TableColumn) -> bool:
    """It rests, and leaps: as commands do, and motion cannot."""
    steps = np.abs(np.diff(column.known))
    return bool(steps.size and np.mean(steps == 0.0) > 0.5 and steps.max() > 0.2 * column.span)


def _as_input(column: TableColumn, output: TableColumn | None) -> float:
    measures, _ = quantity_and_unit(column)
    if is_sign(column) or is_speed_goal(column):
        return 0.0
    if is_pulse(column):
        return 4.0
    named = 5.0 * any(has(column, each) for each in _COMMANDS) - 3.0 * has(column, "derived")
    united = 3.0 * (measures in ("power", "voltage", "current", "torque", "force"))
    other = 5.0 * (
        has(column, "supply")
        or (has(column, "angle") and not is_goal(column) and not has(column, "goal"))
        or has(column, "counter")
    )
    other += 4.0 * (has(column, "speed") or has(column, "mode") or measures in ("time", "speed"))
    beside = 2.0 * _is_beside(column, output)
    bare = 1.5 * (_is_bare(column) or _is_of_one_matrix(column, output)) + 1.0 * _is_stepped(column)
    constant = 2.0 * (column.span == 0.0)
    drive = 1.0 * any(has(column, each) for each in ("power", "voltage"))
    return max(named + united + beside + bare + drive - other - constant, 0.0)


def is_goal(column: TableColumn) -> bool:
    """Whether it is named like a position that a loop is to reach: `cmd_pos` is one, `goal_pwm` is a power."""
    named = has(column, "goal") or (has(column, "told") and has(column, "angle"))
    return named and not any(has(column, each) for each in _NO_GOALS)


def is_speed_goal(column: TableColumn) -> bool:
    """Whether it is the speed that a loop is to hold."""
    return has(column, "goal") and (has(column, "speed") or quantity_and_unit(column)[0] == "speed")


def is_sign(column: TableColumn) -> bool:
    """Whether it tells no more than a direction."""
    few = np.unique(column.known)
    return has(column, "sign") and column.is_whole and 1 < few.size <= len(_SIGNS) and column.largest <= 1.0


def is_pulse(column: TableColumn) -> bool:
    """Whether it holds the lengths of a hobby servo's pulses."""
    low, high = _PULSES_US
    known = column.known
    return (
        has(column, "pulse")
        and bool(known.size)
        and low <= known.min()
        and known.max() <= high
        and column.span > 0.0
    )


def _is_bare(column: TableColumn) -> bool:
    """Its name says nothing: c3."""
    return not any(map(str.isalpha, "".join(column.words).replace("c", "")))


def _is_of_one_matrix(column: TableColumn, output: TableColumn | None) -> bool:
    is_element = output is not None and column.index is not None
    return is_element and split_name(column.name)[0] == split_name(output.name if output else "")[0]


def _is_beside(column: TableColumn, output: TableColumn | None) -> bool:
    """Of the joint of the output, as its index or a word that is not about what is measured tells."""
    if output is None or _is_of_one_matrix(column, output):
        return False
    if column.index is not None or output.index is not None:
        return column.index == output.index
    shared = set(column.words) & set(output.words)
    return any(len(word) > 1 or word in "abc" for word in shared)


def _as_supply(column: TableColumn) -> float:
    low, high = _SUPPLY_V
    scale = 1e-3 if column.largest > 1000.0 else 1.0
    middle = float(np.median(column.known)) * scale if column.known.size else 0.0
    return float(has(column, "supply") and low <= middle <= high)


def _is_mode(column: TableColumn) -> bool:
    few = np.unique(column.known)
    return has(column, "mode") and column.is_whole and 1 < few.size <= _MODES


def names(columns: Sequence[TableColumn]) -> str:
    """The names of columns, for people."""
    return ", ".join(column.name for column in columns[:12]) + (", …" if len(columns) > 12 else "")
