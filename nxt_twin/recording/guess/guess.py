"""A whole mapping, guessed: each key with the reason for it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from glob import escape
from pathlib import Path
from typing import Any, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import MappingError
from nxt_twin.recording.checks import held_commands
from nxt_twin.recording.column_words import INPUTS, OUTPUTS
from nxt_twin.recording.guess.found import Guess
from nxt_twin.recording.guess.joints import joints_beside
from nxt_twin.recording.guess.profile import TableColumn, TableProfile, profile_of
from nxt_twin.recording.guess.robot import RobotColumns, robot_columns
from nxt_twin.recording.guess.robot_guess import robot_guesses
from nxt_twin.recording.guess.roles import (
    Roles,
    disorder_of,
    is_of,
    is_pulse,
    is_speed_goal,
    names,
    roles_of,
    wrap_of,
)
from nxt_twin.recording.guess.scales import (
    input_scale,
    output_scale,
    pulse_line,
    step_of,
    time_unit,
    turn_length,
)
from nxt_twin.recording.guess.signs import sign_values
from nxt_twin.recording.guess.united import united_cells
from nxt_twin.recording.guess.vocabulary import MODE_WORDS, has
from nxt_twin.recording.source import quoted
from nxt_twin.recording.tables.nested import split_name
from nxt_twin.recording.unsigned import lost_sign

_IN_NAME = re.compile(
    r"(power|pwm|duty|volt(?:age)?|spannung)[^\d+-]{0,3}([+-]?\d+(?:\.\d+)?)", re.IGNORECASE
)
_HIGHEST_V = 24.0
_NAMED_MOST = 6
_FEW_REPEATED = 0.02
_WHY_JOINTS = (
    "other joints that move; those before it tilt it, those behind it change its load. CHECK each sign, and take out "
    "those that do not bear on its weight"
)


@final
@dataclass(frozen=True)
class Guessed:
    """The guess of a table's meaning.

    Attributes:
        profile: the table as it was found.
        guesses: the keys of its mapping, in order.
        lacking: why it is no whole mapping, where one of the keys could not be guessed.
    """

    profile: TableProfile
    guesses: tuple[Guess, ...]
    lacking: MappingError | None = None

    @property
    def keys(self) -> dict[str, Any]:
        """The mapping's keys."""
        return {guess.key: guess.value for guess in self.guesses}


def guess_mapping(path: Path, joint: str | None = None) -> Guessed:
    """Guess a table's mapping.

    Args:
        path: the table.
        joint: by name or index, of a table with several; None takes the one that moves most.

    Raises:
        RecordingError: it is no table of numbers.
        MappingError: it has no such joint.
    """
    profile = profile_of(path)
    if joint is not None:
        _check_joint(profile, joint)
    roles = roles_of(profile, joint)
    robot = robot_columns(profile.columns, (roles.time, roles.split))
    if joint is None and robot.is_robots:
        return _robots(profile, roles, robot)
    found = [_table(profile)]
    lacking = None
    for guess in (_time, _input, _output):
        try:
            found.append(guess(profile, roles))
        except MappingError as error:
            lacking = lacking or (_named_twice(profile) if profile.twice else error)
    if lacking is not None:
        lacking = united_cells(profile) or lacking
    others = joints_beside(profile.columns, roles.output)
    if others:
        found.append(Guess("gravity_of", others, _WHY_JOINTS))
    return Guessed(profile, (*found, *_optional(profile, roles)), lacking)


def _robots(profile: TableProfile, roles: Roles, robot: RobotColumns) -> Guessed:
    """The guess of a table that a robot on two wheels fills."""
    found = [_table(profile)]
    own, lacking = robot_guesses(profile, robot)
    try:
        found.append(_time(profile, roles))
    except MappingError as error:
        lacking = error
    if lacking is not None:
        lacking = united_cells(profile) or lacking
    rest = [guess for guess in _optional(profile, roles) if guess.key in ("supply", "split")]
    return Guessed(
        profile, (*found, *own, *rest), _named_twice(profile) if lacking and profile.twice else lacking
    )


def _named_twice(profile: TableProfile) -> MappingError:
    what = f"has several columns named {quoted(profile.twice[0])}"
    skip = 1 + (profile.layout.skip if profile.layout else 0)
    mend = f"rename them, or write `table: {{header: false, skip: {skip}}}` and name columns c1, c2, … in a mapping"
    return MappingError(what, where=str(profile.path), mend=mend)


def _check_joint(profile: TableProfile, joint: str) -> None:
    """Refuse a joint that no column is of."""
    if not any(is_of(column, joint) for column in profile.columns):
        known = _known(profile)
        what = f"has no column of the joint {quoted(joint)}"
        mend = f"write `output: {{column: …}}` in a mapping; its columns are {known}"
        raise MappingError(what, where=str(profile.path), mend=mend)


def _optional(profile: TableProfile, roles: Roles) -> Iterator[Guess]:
    if roles.supply is not None:
        gain = 1e-3 if roles.supply.largest > 1000.0 else 1.0
        yield Guess("supply", roles.supply.keys | _gain(gain), "named like a supply, and in its range")
    modes = [*map(_flag, roles.modes), *_worded(profile)]
    if modes:
        several = "; of several columns the first that is not drive decides" if len(modes) > 1 else ""
        why = f"few values; CHECK what each of them means{several}"
        yield Guess("mode", modes if len(modes) > 1 else modes[0], why)
    if roles.split is None and roles.time is not None and disorder_of(roles.time) == "runs":
        yield Guess("split", roles.time.keys | {"falls": True}, "the time begins anew with each run")
    if roles.split is not None:
        runs = np.unique(roles.split.known).size
        yield Guess("split", roles.split.keys, f"{runs} runs, one after the other")


def _flag(column: TableColumn) -> dict[str, Any]:
    """A column of whole numbers: 0 is off, unless the column is named after braking or coasting."""
    named = next((word for word in column.words if word in ("brake", "coast")), "")
    at_zero, else_ = ("drive", named) if named else ("coast", "drive")
    values = {f"{value:g}": else_ if value else at_zero for value in np.unique(column.known).tolist()}
    return column.keys | {"values": values}


def _worded(profile: TableProfile) -> Iterator[dict[str, Any]]:
    """The columns of words that say what the bridge does."""
    for name, words in profile.others.items():
        meant = {word: MODE_WORDS[word.lower()] for word in words if word.lower() in MODE_WORDS}
        if words and len(meant) == len(words):
            yield {"column": name, "values": meant}


def _table(profile: TableProfile) -> Guess:
    """The format, as far as the content of another file might not tell it."""
    layout = profile.layout
    if layout is None:
        found = (
            "a folder that holds meta/info.json" if profile.kind == "lerobot" else "by the file's first bytes"
        )
        return Guess("table", {"format": profile.kind}, found)
    keys: dict[str, Any] = {"format": "csv", "delimiter": layout.delimiter, "header": layout.header}
    optional = {
        "decimal": "," if layout.decimal == "," else None,
        "transposed": layout.transposed or None,
        "skip": layout.skip or None,
        "ragged": layout.ragged or None,
        "thousands": layout.thousands or None,
        "units_row": layout.units_row or None,
        "encoding": layout.encoding if layout.encoding in ("utf-16", "cp1252") else None,
    }
    keys |= {key: value for key, value in optional.items() if value is not None}
    head = "the first line names the columns" if layout.header else "the first line holds numbers"
    ragged = "; some lines have another number of cells and are left out; CHECK" if layout.ragged else ""
    return Guess("table", keys, f"the delimiter that cuts all lines into as many numbers; {head}{ragged}")


def _time(profile: TableProfile, roles: Roles) -> Guess:
    if roles.time is None:
        known = _known(profile)
        which = "no column that grows from row to row as time does"
        mend = f"write `time: {{period_s: 0.01}}` in a mapping, with the log's own period; its columns are {known}"
        raise MappingError(f"has {which}", where=str(profile.path), mend=mend)
    unit, why = time_unit(roles.time)
    repeated = np.mean(np.diff(roles.time.values) == 0.0)
    if repeated > _FEW_REPEATED:
        why += f"; {repeated:.0%} of the rows repeat the stamp before: a coarser clock, or rows twice; CHECK"
    disorder = None if roles.split else disorder_of(roles.time)
    if disorder == "wraps":
        wrap = wrap_of(roles.time)
        return Guess(
            "time", roles.time.keys | {"unit": unit, "wraps_at": wrap}, f"{why}; starts anew at {wrap:g}"
        )
    if disorder == "sort":
        return Guess(
            "time",
            roles.time.keys | {"unit": unit, "sort": True},
            f"{why}; rows are out of order; CHECK",
        )
    return Guess("time", roles.time.keys | {"unit": unit}, why)


def _known(profile: TableProfile) -> str:
    """The columns that may be meant, and those that may not, for people."""
    numbers = names(profile.columns)
    if not profile.others:
        return numbers
    words = ", ".join(list(profile.others)[:_NAMED_MOST])
    return f"{numbers}; cells that are no numbers are in {words}"


def _output(profile: TableProfile, roles: Roles) -> Guess:
    column = roles.output
    if column is None:
        which = "no column that looks like a measured angle, position or speed"
        still = [c for c in profile.columns if c.span == 0.0 and (has(c, "angle") or has(c, "speed"))]
        which = f"no reading that moves: {names(still)} never changes" if still else which
        known = _known(profile)
        mend = f"write `output: {{column: …, kind: position_deg}}` in a mapping; its columns are {known}"
        raise MappingError(f"has {which}", where=str(profile.path), mend=mend)
    role, unit, size, why = output_scale(column, roles.time)
    kind, gain = OUTPUTS[role][unit]
    gain *= size
    step = step_of(column) * abs(gain)
    turn = turn_length(column)
    keys = {**column.keys, "kind": kind, **_gain(gain), **({"step": _short(step)} if step else {})}
    keys |= {"wraps_at": turn} if turn else {}
    taken = (column, roles.time, roles.input, roles.supply)
    rest = [c for c in profile.columns if c not in taken and _alike(c, column)]
    slope = roles.slopes.get(column.name)
    why += f"; {slope} is its slope" if slope else ""
    joints = ", ".join(c.joint or c.name for c in rest[:12])
    others = f"; others that might be meant: {joints} (--joint)" if rest else ""
    shown = kind.partition("_")[2].replace("_per_", "/")
    return Guess("output", keys, f"{why}; spans {_short(column.span * gain)} {shown}{others}")


def _alike(one: TableColumn, other: TableColumn) -> bool:
    return split_name(one.name)[0] == split_name(other.name)[0] and one.index is not None


def _input(profile: TableProfile, roles: Roles) -> Guess:
    if roles.input is not None and roles.output is not None:
        role, unit, size, why = input_scale(roles.input, roles.output, roles.time)
        kind, gain = INPUTS[role][unit]
        keys = roles.input.keys | {"kind": kind} | _gain(gain * size)
        turn = turn_length(roles.output) if role == "goal" and roles.input.known.min() >= 0.0 else 0.0
        keys |= {"wraps_at": turn} if roles.input.largest <= turn else {}
        if is_pulse(roles.input):
            keys |= _pulse(roles.input, roles.output, roles.time)
        if roles.sign is not None:
            keys["sign"] = roles.sign.keys | {"values": sign_values(roles.sign, roles.input, roles.output)}
            why += f"; {roles.sign.name} tells its direction, by which way the reading goes"
        elif role != "goal" and lost_sign(*_driven(roles.input, roles.output, roles.time)):
            why += (
                f"; it has one sign, and {roles.output.name} goes both ways under it: CHECK for a lost sign"
            )
        return Guess("input", keys, why)
    named = _IN_NAME.search(profile.path.name)
    if named:
        value = float(named[2])
        is_volts = named[1].lower()[0] in "vs" and abs(value) <= _HIGHEST_V
        kind = "voltage_v" if is_volts else "power_pct"
        why = f"the file's name says {quoted(named[0])}; CHECK that it is constant throughout"
        return Guess("input", {"value": _by_file(profile.path, named) or value, "kind": kind}, why)
    if roles.output is None:  # which of the others is the command, its motion would tell
        return _output(profile, roles)
    loop = next(filter(is_speed_goal, profile.columns), None)
    if loop is not None:
        mend = "write `input: {column: …, kind: power_pct}` with what the loop commands, or log it"
        what = f"commands a speed, in {quoted(loop.name)}, and no plant follows one"
        raise MappingError(what, where=str(profile.path), mend=mend)
    known = names([column for column in profile.columns if column not in (roles.time, roles.output)])
    which = "no column that looks like a command, and no constant one in its name"
    rest = f"; its other columns are {known}" if known else ""
    either = "`input: {column: …, kind: power_pct}` or `input: {value: 60, kind: power_pct}`"
    mend = f"write {either} in a mapping{rest}"
    raise MappingError(f"has {which}", where=str(profile.path), mend=mend)


def _driven(
    command: TableColumn, reading: TableColumn, time: TableColumn | None
) -> tuple[FloatArray, FloatArray]:
    """The command in force in each row that has a reading, and how far the motor has come there."""
    rows = np.isfinite(reading.values)
    held = held_commands(command.values, float(command.known[0]))[rows]
    if output_scale(reading, time)[0] == "speed":
        return held, np.cumsum(reading.values[rows])
    turn = turn_length(reading)
    return held, np.unwrap(reading.values[rows], period=turn) if turn else reading.values[rows]


def _pulse(command: TableColumn, reading: TableColumn, time: TableColumn | None) -> dict[str, float]:
    """Gain and offset of a hobby servo's pulses: those by which the reading follows, else those of most servos."""
    role, unit, size, _ = output_scale(reading, time)
    gain, offset = pulse_line(command, reading, OUTPUTS[role][unit][1] * size if role == "angle" else 0.0)
    return {"gain": _short(gain), "offset": _short(offset)}


def _by_file(path: Path, named: re.Match[str]) -> dict[str, float]:
    """The values in the names of the files beside this one that differ from it in that number only."""
    before, after = path.name[: named.start(2)], path.name[named.end(2) :]
    alike = re.compile(re.escape(before) + r"([+-]?\d+(?:\.\d+)?)" + re.escape(after))
    found = [
        match for match in map(alike.fullmatch, sorted(each.name for each in path.parent.iterdir())) if match
    ]
    return {escape(match[0]): float(match[1]) for match in found} if len(found) > 1 else {}


def _gain(gain: float) -> dict[str, Any]:
    return {} if gain == 1.0 else {"gain": _short(gain)}


def _short(value: float) -> float:
    return float(f"{value:.8g}")
