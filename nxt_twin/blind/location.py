"""The benchmark's table of where: how often the equation and the onset are right, and how honest p-values are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any, Final, final, get_args

from nxt_twin.blind.aims import is_detectable
from nxt_twin.blind.kinds import Equation
from nxt_twin.blind.located import ALARM_P
from nxt_twin.blind.share import Share, share_of
from nxt_twin.blind.verdict import Judged

NEAR_S: Final = 0.3


@final
@dataclass(frozen=True)
class WhereRow:
    """One group of cases with one thing hidden.

    Attributes:
        group: what they have in common.
        named: the equation that the diagnosis names is right.
        unaided: the loudest source is right; no effect's name takes part in it.
    """

    group: str
    named: Share
    unaided: Share


@final
@dataclass(frozen=True)
class Onsets:
    """What became of events within a recording.

    Attributes:
        near: found within 0.3 s, of all events.
        held: the bounds hold the true moment, of those found.
        error_s: median error of those found; None without any.
        feigned: cases with an onset, of those in which nothing sets in.
    """

    near: Share
    held: Share
    error_s: float | None
    feigned: Share


@final
@dataclass(frozen=True)
class Location:
    """All of it.

    Attributes:
        rows: by kind of case and equation.
        onsets: of events.
        alarms: clean cases in which any source's p-value is below 1 %, of those whose diagnosis gives them.
    """

    rows: tuple[WhereRow, ...]
    onsets: Onsets
    alarms: Share

    def row(self, group: str) -> WhereRow:
        """The line of one group."""
        return next(row for row in self.rows if row.group == group)

    def as_dict(self) -> dict[str, Any]:
        """The table as JSON values."""
        onsets = self.onsets
        return {
            "equations": [
                {"group": row.group, "named": row.named.as_dict(), "unaided": row.unaided.as_dict()}
                for row in self.rows
            ],
            "onsets": {
                "near": onsets.near.as_dict(),
                "held": onsets.held.as_dict(),
                "median_error_s": onsets.error_s,
                "feigned": onsets.feigned.as_dict(),
            },
            "clean_alarms": self.alarms.as_dict(),
        }

    def as_text(self) -> str:
        """The table for a terminal or a page, in fixed-width columns."""
        cells = [("where", "equation", "without any name")]
        cells += [(row.group, str(row.named), str(row.unaided)) for row in self.rows]
        widths = [max(len(line[column]) for line in cells) for column in range(3)]
        lines = [
            "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
            for line in cells
        ]
        onsets = self.onsets
        error = "" if onsets.error_s is None else f", median error of those found {onsets.error_s:.2f} s"
        lines += [
            "",
            f"onset within {NEAR_S} s: {onsets.near}{error}; its bounds hold: {onsets.held}",
            f"onset where nothing sets in: {onsets.feigned}",
            f"clean cases with a p-value below {ALARM_P:g} in any source: {self.alarms}",
        ]
        return "\n".join(lines) + "\n"


def location(cases: Sequence[Judged]) -> Location:
    """Count: single effects by equation, whether all or those that could be seen; those that no library holds."""
    singles = [case for case in cases if case.kind == "single"]
    unknown = [case for case in cases if case.kind == "unknown"]
    rows = [
        *_rows("single", singles),
        *_rows("single, detectable", [case for case in singles if is_detectable(case)]),
        *_rows("unknown", unknown),
    ]
    return Location(
        rows=tuple(row for row in rows if row.named.of),
        onsets=_onsets(cases),
        alarms=share_of(case.located.alarm for case in cases if case.kind == "clean"),
    )


def _rows(kind: str, cases: Sequence[Judged]) -> list[WhereRow]:
    by_equation = [
        _row(f"{kind}, {equation}", [case for case in cases if case.located.truth == equation])
        for equation in get_args(Equation)
    ]
    return [_row(kind, cases), *by_equation]


def _row(group: str, cases: Sequence[Judged]) -> WhereRow:
    return WhereRow(
        group,
        share_of(case.located.named for case in cases),
        share_of(case.located.unaided for case in cases),
    )


def _onsets(cases: Sequence[Judged]) -> Onsets:
    alone = [case.located for case in cases if case.kind in ("clean", "single", "unknown")]
    events = [one for one in alone if one.event is not None]
    errors_s = [one.onset_error_s for one in events]
    found_s = [error_s for error_s in errors_s if error_s is not None]
    return Onsets(
        near=share_of(error_s is not None and error_s <= NEAR_S for error_s in errors_s),
        held=share_of(one.onset_held for one in events),
        error_s=median(found_s) if found_s else None,
        feigned=share_of(one.onset is not None for one in alone if one.event is None),
    )
