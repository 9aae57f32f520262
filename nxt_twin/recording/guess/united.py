"""Cells that hold a number with its unit, `50 %` or `20 ms`: nobody reads such as numbers."""

from __future__ import annotations

import re
from itertools import islice
from typing import Final

from nxt_twin.errors import MappingError
from nxt_twin.recording.guess.profile import TableProfile
from nxt_twin.recording.guess.vocabulary import is_unit
from nxt_twin.recording.source import quoted
from nxt_twin.recording.tables.lines import TextLayout, iterate_lines

_LINES: Final = 20
_CELL: Final = re.compile(
    r"""(?:^|[;,\t|])["']?\s*(?P<cell>[+-]?\d+(?:\.\d+)?\s*(?P<unit>[^\W\d][^\s;,|"']{0,6}|[%°][^\s;,|"']{0,3}))\s*["']?(?=[;,\t|]|$)"""
)


def united_cells(profile: TableProfile) -> MappingError | None:
    """The refusal of a text table whose cells hold units; None where they do not."""
    if profile.layout is None:
        return None
    whole = TextLayout(delimiter="\0", header=False, encoding=profile.layout.encoding)
    for number, cells in islice(iterate_lines(profile.path, whole), _LINES):
        for found in _CELL.finditer(cells[0] if cells else ""):
            if is_unit(found["unit"]):
                where = f"{profile.path}, row {number}"
                mend = "write the number alone, and the unit into the column's name, such as power_pct or time_ms"
                return MappingError(f"has a unit in a cell: {quoted(found['cell'])}", where=where, mend=mend)
    return None
