"""Tables from elsewhere, read through a mapping as recordings."""

from __future__ import annotations

from collections.abc import Mapping as MappingType
from collections.abc import Sequence
from fnmatch import fnmatchcase
from math import nan, pi
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.errors import MappingError, RecordingError
from nxt_twin.recording.any_mapping import AnyMapping
from nxt_twin.recording.checks import (
    check_finite,
    check_range,
    check_row_count,
    held_commands,
)
from nxt_twin.recording.columns import DRIVE_MODES
from nxt_twin.recording.joints import stretches_at_rest
from nxt_twin.recording.mapped_robot import robot_recording
from nxt_twin.recording.mapping import (
    POWER_LIMIT_PCT,
    InputSource,
    Mapping,
    ModeSource,
    OutputSource,
    SignSource,
    SplitColumn,
    TableFormat,
)
from nxt_twin.recording.recording import GOALS, InputKind, OutputKind, Recording, SignalKinds
from nxt_twin.recording.robot_keys import ROBOT_KEYS
from nxt_twin.recording.robot_mapping import RobotMapping
from nxt_twin.recording.source import nearest_name, quoted
from nxt_twin.recording.stamps import IN_WORDS, order, time_s
from nxt_twin.recording.tables.content import TableKind
from nxt_twin.recording.tables.loose import as_word
from nxt_twin.recording.tables.open import read_table, table_file
from nxt_twin.recording.tables.table import CellKind, Choose, Table
from nxt_twin.recording.turns import at_nearest_turn

_DEGREE = pi / 180.0
_OUTPUT_SI: MappingType[OutputKind, tuple[OutputKind, float]] = MappingProxyType(
    {
        "position_deg": ("position_rad", _DEGREE),
        "speed_deg_per_s": ("speed_rad_per_s", _DEGREE),
        "position_rad": ("position_rad", 1.0),
        "speed_rad_per_s": ("speed_rad_per_s", 1.0),
        "position_m": ("position_m", 1.0),
        "speed_m_per_s": ("speed_m_per_s", 1.0),
    }
)
_INPUT_SI: MappingType[InputKind, tuple[InputKind, float]] = MappingProxyType(
    {"goal_position_deg": ("goal_position_rad", _DEGREE)}
)
_PART = "#"
_FLAGS = {"true": "1", "false": "0"}


def read_mapped(path: Path, mapping: AnyMapping) -> Recording:
    """Read a table that holds one recording, as `read_all_mapped` does.

    Raises:
        MappingError: as `read_all_mapped`, or the table holds several recordings.
        RecordingError: as `read_all_mapped`.
    """
    recordings = read_all_mapped(path, mapping)
    if len(recordings) > 1:
        names = ", ".join(recording.name for recording in recordings[:3])
        mend = f"name one of them: {names}, …"
        raise MappingError(f"holds {len(recordings)} recordings", where=str(path), mend=mend)
    return recordings[0]


def read_all_mapped(path: Path, mapping: AnyMapping) -> tuple[Recording, ...]:
    """Read a table from elsewhere as recordings with the columns `time_s`, `input`, `output`, `mode` and `supply_v`.

    A robot's table has the columns of a brick's recording instead, with its wheels on ports b and c.

    All are SI but for a `power_pct` input. A row without an input gets the input in force, 0 before the
    first. Outputs and supply are NaN where not sampled. A mapping with a `split` gives one
    recording for each value of that column; `FILE#VALUE` is one of them.

    Raises:
        MappingError: if the table lacks a mapped column.
        RecordingError: if the table cannot be read, or its stamps or values cannot be a recording's.
    """
    file, part = _file_and_part(path)
    table = read_table(file, _chooser(file, mapping), _kind(mapping.table), _layout(mapping.table))
    if mapping.split is None:
        return _of_one_run(table, file, mapping, path.name)
    runs = _runs(table, mapping.split)
    if part and part not in runs:
        mend = f"nearest known: {nearest_name(part, runs)}"
        raise MappingError(f"has no {mapping.split.column} {quoted(part)}", where=str(file), mend=mend)
    chosen = {part: runs[part]} if part else runs
    return tuple(
        each
        for label, rows in chosen.items()
        for each in _of_one_run(_some_rows(table, rows), file, mapping, f"{file.name}{_PART}{label}")
    )


def _of_one_run(table: Table, path: Path, mapping: AnyMapping, name: str) -> tuple[Recording, ...]:
    """A run's recording; of an arm's joint, one for each stretch in which the other joints rest."""
    rows = order(table, mapping.time)
    table = table if rows is None else _some_rows(table, rows)
    if isinstance(mapping, RobotMapping):
        return (robot_recording(table, path, mapping, name),)
    recording = _recording(table, path, mapping, name)
    if not mapping.gravity_of:
        return (recording,)
    angles = {
        joint: table.numbers[source.column] * _OUTPUT_SI[source.kind][1]
        for joint, source in mapping.gravity_of.items()
    }
    signs = {joint: source.sign for joint, source in mapping.gravity_of.items()}
    return stretches_at_rest(recording, angles, signs)


def _file_and_part(path: Path) -> tuple[Path, str]:
    """A table's file, and which of its recordings is meant."""
    stem, mark, part = path.name.rpartition(_PART)
    if mark and not path.exists() and (path.parent / stem).exists():
        return table_file(path.parent / stem), part
    return table_file(path), ""


def _layout(table: TableFormat) -> dict[str, object]:
    """What a mapping states of a text table."""
    known = table.model_dump(exclude_none=True, exclude={"format", "lines"})
    if known.get("encoding") == "utf-8":
        known["encoding"] = "utf-8-sig"
    return known


def _kind(table: TableFormat) -> TableKind | None:
    return table.lines or table.format


def _sources(mapping: AnyMapping) -> list[tuple[str, Any]]:
    """What a mapping names columns in, by key."""
    if isinstance(mapping, RobotMapping):
        return [(key, getattr(mapping, key)) for key in ("time", *ROBOT_KEYS, "supply", "split")]
    plain = ("time", "input", "output", "supply", "split")
    sources: list[tuple[str, Any]] = [(key, getattr(mapping, key)) for key in plain]
    sources += [("input.sign", mapping.input.sign), *(("mode", each) for each in mapping.mode)]
    return [*sources, *(("gravity_of", each) for each in mapping.gravity_of.values())]


def _chooser(path: Path, mapping: AnyMapping) -> Choose:
    """Chooses the mapped columns, and refuses a table that lacks one by the key that names it."""
    wanted = [
        (key, source.column) for key, source in _sources(mapping) if source and source.column is not None
    ]
    labels = ("mode", "split", "input.sign", *(("time",) if mapping.time.unit in IN_WORDS else ()))

    def choose(found: Sequence[str]) -> MappingType[str, CellKind]:
        for key, name in wanted:
            if name in found and found.count(name) == 1:
                continue
            count = "no column" if name not in found else "more than one column"
            near = f"write `{key}: {{column: …}}` anew; nearest known: {nearest_name(name, found)}"
            mend = (
                near
                if name not in found
                else "rename one, or write `table: {header: false, skip: 1}` and name columns c1, c2, …"
            )
            raise MappingError(f"has {count} {quoted(name)}", where=f"{path}, mapping key {key}", mend=mend)
        chosen: dict[str, CellKind] = {name: "label" for key, name in wanted if key in labels}
        return {**chosen, **{name: "number" for key, name in wanted if key not in labels}}

    return choose


def _runs(table: Table, split: SplitColumn) -> dict[str, IntArray]:
    """The rows of each recording, by the value of the column that splits them; in order of appearance."""
    rows: dict[str, list[int]] = {}
    labels = _labels(table, split.column)
    for row, label in enumerate(_numbered(table, split.column, labels) if split.falls else labels):
        if label:
            rows.setdefault(label, []).append(row)
    return {label: np.array(own) for label, own in rows.items()}


def _numbered(table: Table, column: str, labels: Sequence[str]) -> list[str]:
    """The number of the run that each row belongs to, from 1 on: a new one begins where the column falls."""
    values = table.numbers.get(column)
    values = np.array([_or_nan(label) for label in labels]) if values is None else values
    begins = np.concatenate([[True], np.diff(held_commands(values, values[0])) < 0.0])
    return [str(number) for number in np.cumsum(begins).tolist()]


def _some_rows(table: Table, rows: IntArray) -> Table:
    return Table(
        numbers={name: values[rows] for name, values in table.numbers.items()},
        words={name: tuple(words[row] for row in rows.tolist()) for name, words in table.words.items()},
        place=lambda index, column: table.place(int(rows[index]), column),
    )


def _recording(table: Table, path: Path, mapping: Mapping, name: str) -> Recording:
    output = table.numbers[mapping.output.column]
    rows = output.size
    check_row_count(rows, path)
    if np.isnan(output).all():
        where, mend = (
            f"{path}, column {mapping.output.column}",
            "map the column that was measured as `output`",
        )
        raise RecordingError("is empty", where=where, mend=mend)
    for column, values in table.numbers.items():
        check_finite(table, column, values)
    with np.errstate(over="ignore", invalid="ignore"):  # refused below
        columns = _columns(table, path, mapping, output)
    for signal, values in columns.items():
        if np.isinf(values).any():
            mend = "check the mapping's gain and unit"
            raise RecordingError("becomes larger than a number can be", where=f"{path}, {signal}", mend=mend)
    output_kind, to_si = _OUTPUT_SI[mapping.output.kind]
    return Recording(
        name=name,
        columns=columns,
        kinds=SignalKinds(_INPUT_SI.get(mapping.input.kind, (mapping.input.kind, 1.0))[0], output_kind),
        output_quantum=_quantum(output, mapping.output) * to_si,
    )


def _columns(table: Table, path: Path, mapping: Mapping, output: FloatArray) -> dict[str, FloatArray]:
    rows, (_, to_si) = output.size, _OUTPUT_SI[mapping.output.kind]
    columns = {
        "time_s": time_s(table, mapping.time, rows),
        "input": _input(table, mapping, path, rows),
        "output": (_unwrapped(output, mapping.output) * mapping.output.gain + mapping.output.offset) * to_si,
    }
    if mapping.mode:
        columns["mode"] = _mode(table, mapping.mode)
    if mapping.supply is not None:
        supply = table.numbers[mapping.supply.column]
        columns["supply_v"] = supply * mapping.supply.gain + mapping.supply.offset
    return columns


def _input(table: Table, mapping: Mapping, path: Path, rows: int) -> FloatArray:
    source = mapping.input
    to_si = _INPUT_SI.get(source.kind, (source.kind, 1.0))[1]
    if source.column is None:
        return np.full(rows, (_constant(source, path) * source.gain + source.offset) * to_si)
    size = table.numbers[source.column]
    if source.sign is not None:
        size = np.abs(size) * _sign(table, source.sign)
    if source.wraps_at is not None:
        reading = _unwrapped(table.numbers[mapping.output.column], mapping.output)
        size = at_nearest_turn(held_commands(size, size[0]), reading, source.wraps_at)
    values = (size * source.gain + source.offset) * to_si
    known = values[np.isfinite(values)]
    values = held_commands(values, float(known[0]) if source.kind in GOALS and known.size else 0.0)
    if source.kind == "power_pct":
        mend = "write `input: {gain: …}`, such as 0.392 for a duty of 8 bits"
        check_range(table, source.column, values, -POWER_LIMIT_PCT, POWER_LIMIT_PCT, mend=mend)
    return values


def _constant(source: InputSource, path: Path) -> float:
    """A constant input, which may differ by file."""
    if not isinstance(source.value, dict):
        return source.value or 0.0
    found = [value for pattern, value in source.value.items() if fnmatchcase(path.name, pattern)]
    if len(found) != 1:
        count = "several patterns" if found else "no pattern"
        where, mend = f"{path}, mapping key input.value", f"write `{path.name}: VALUE`"
        raise MappingError(f"is named by {count}", where=where, mend=mend)
    return found[0]


def _sign(table: Table, source: SignSource) -> FloatArray:
    """The command's direction in each row; an empty cell changes nothing."""
    sign_of = {_truth(word): float(sign) for word, sign in source.values.items()}
    labels = list(map(_truth, _labels(table, source.column)))
    for row, label in enumerate(labels):
        if label and label not in sign_of:
            mend = f"write `input: {{sign: {{values: {{{label}: -1}}}}}}`, or 1, or 0"
            where = table.place(row, source.column)
            raise MappingError(f"has no sign for {quoted(label)}", where=where, mend=mend)
    return held_commands(np.array([sign_of[label] if label else nan for label in labels]))


def _or_nan(label: str) -> float:
    try:
        return float(label)
    except ValueError:
        return nan


def _mode(table: Table, sources: Sequence[ModeSource]) -> FloatArray:
    """From each row on the mode of the first column that is not `drive`, as an index into `DRIVE_MODES`."""
    mode, *others = [_mode_of_one(table, source) for source in sources]
    for other in others:
        mode = np.where(mode == DRIVE_MODES.index("drive"), other, mode)
    return mode


def _mode_of_one(table: Table, source: ModeSource) -> FloatArray:
    """The drive mode that one column tells; an empty cell changes nothing."""
    index_of = {_truth(word): float(DRIVE_MODES.index(mode)) for word, mode in source.values.items()}
    labels = list(map(_truth, _labels(table, source.column)))
    for row, label in enumerate(labels):
        if label and label not in index_of:
            mend = f"write `mode: {{values: {{{label}: coast}}}}`, or drive, float, brake"
            raise MappingError(
                f"has no mode for {quoted(label)}", where=table.place(row, source.column), mend=mend
            )
    return held_commands(np.array([index_of[label] if label else nan for label in labels]))


def _labels(table: Table, column: str) -> list[str]:
    """A column's cells as labels; one that is mapped as a number too is read as such."""
    words = table.words.get(column)
    return [
        _plain(word) for word in (map(as_word, table.numbers[column].tolist()) if words is None else words)
    ]


def _plain(label: str) -> str:
    """`0`, `0.0` and `0.00` are one label, and so are `True` and `true`."""
    try:
        return as_word(float(label))
    except ValueError:
        return label.strip().lower()


def _truth(label: str) -> str:
    """A label, with `true` and `false` as the flags 1 and 0."""
    return _FLAGS.get(_plain(label), _plain(label))


def _unwrapped(output: FloatArray, source: OutputSource) -> FloatArray:
    if source.wraps_at is None:
        return output
    known = np.isfinite(output)
    whole = output.copy()
    whole[known] = np.unwrap(output[known], period=source.wraps_at)
    return whole


def _quantum(output: FloatArray, source: OutputSource) -> float:
    """The output's smallest step in the unit of its kind."""
    if source.step is not None:
        return source.step
    if source.quantum is not None:
        return source.quantum * abs(source.gain)
    sampled = output[~np.isnan(output)]
    is_counted = bool(np.all(sampled == np.rint(sampled))) and sampled.min() < sampled.max()
    return abs(source.gain) if is_counted else 0.0
