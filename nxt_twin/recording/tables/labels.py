"""Text whose lines name each value: `t:12 pwm:40 angle=3.5`, as boards print it on their serial line."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from nxt_twin.errors import RecordingError
from nxt_twin.recording.source import read_head
from nxt_twin.recording.tables.loose import loose_table
from nxt_twin.recording.tables.table import Choose, Table

LARGEST_LABELS_BYTES = 128 * 2**20

_PAIR = re.compile(
    r"(?P<name>[^\W\d][\w./%°\[\]() -]{0,40}?)\s*[:=]\s*"
    r"(?P<value>[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|nan|true|false)"
    r"(?![\w:.])",
    re.IGNORECASE,
)
_TRUTHS = {"true": 1.0, "false": 0.0}
_FEWEST_PAIRS = 2
_MOST_OF_LINES = 0.5


def is_labelled(lines: Sequence[str]) -> bool:
    """Whether most lines name at least two values each."""
    written = [line for line in lines if line.strip()]
    return bool(written) and sum(map(_is_row, written)) > _MOST_OF_LINES * len(written)


def read_labels(path: Path, choose: Choose) -> Table:
    """Read the chosen columns of a text whose lines name each value; lines that name fewer than two are left out.

    Raises:
        RecordingError: if no line names two values, or it is not UTF-8. `choose` may raise its own.
    """
    advice = "split it into shorter recordings"
    read_head(path, RecordingError, largest_bytes=LARGEST_LABELS_BYTES, advice=advice)
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise RecordingError("is not UTF-8 text", where=str(path), mend="save it as UTF-8") from None
    rows = [_pairs(line) for line in lines if _is_row(line)]
    if not rows:
        mend = "leave `table: {lines: labels}` out of the mapping"
        raise RecordingError("names no two values in a line", where=str(path), mend=mend)
    names = dict.fromkeys(name for row in rows for name in row)
    return loose_table({name: [row.get(name) for row in rows] for name in names}, path, choose)


def _is_row(line: str) -> bool:
    return len(_pairs(line)) >= _FEWEST_PAIRS


def _pairs(line: str) -> dict[str, float]:
    """The values of a line by name."""
    found = ((match["name"].strip(), match["value"].lower()) for match in _PAIR.finditer(line))
    return {name: _TRUTHS[value] if value in _TRUTHS else float(value) for name, value in found}
