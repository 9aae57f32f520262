"""Which unit, session and batch a recording belongs to, by where it lies."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Final, Literal, final

Level = Literal["batch", "unit", "session", "-"]
USUAL_LEVELS: Final[tuple[Level, ...]] = ("unit", "session")
_NAMED: Final = ("batch", "unit", "session")
_DATE: Final = re.compile(r"(\d{4})-?(\d{2})-?(\d{2})(?:[T _-]?(\d{2})[:.-]?(\d{2})(?:[:.-]?(\d{2}))?)?")


@final
@dataclass(frozen=True)
class Labels:
    """Whose recording it is.

    Attributes:
        unit: the thing, among many alike.
        session: the occasion; empty where the unit has one alone.
        batch: the lot that the unit came from; empty where it is not known.
    """

    unit: str
    session: str = ""
    batch: str = ""

    @property
    def when(self) -> datetime | None:
        """The date and time that the session's name holds, taken as UTC; None where it holds none."""
        found = _DATE.search(self.session)
        try:
            return datetime(*(int(part) for part in found.groups() if part), tzinfo=UTC) if found else None  # type: ignore[misc,arg-type]
        except ValueError:
            return None


def is_session(folders: Sequence[str], levels: Sequence[Level]) -> bool:
    """Whether all that lies in a folder is of one session: then its tables are one case."""
    return bool(_named(folders, levels)[0].get("session"))


def labels_of(folders: Sequence[str], levels: Sequence[Level], file: str = "") -> Labels:
    """The labels of a folder below the fleet's, or of a single file in it.

    A part such as `unit=7` names itself, as in a partitioned Parquet data set. The other parts name the `levels` in
    turn, and parts beyond them belong to the session.

    Args:
        folders: parts of the path.
        levels: what folders stand for, the outermost first.
        file: the name of a table that is a session of its own, without its ending.
    """
    known, free = _named([*folders, file] if file else folders, levels)
    session = "/".join(part for part in (known.get("session", ""), *free) if part)
    return Labels(
        known.get("unit") or session or file, session if known.get("unit") else "", known.get("batch", "")
    )


def _named(parts: Sequence[str], levels: Sequence[Level]) -> tuple[dict[str, str], list[str]]:
    """Labels by level, and the parts that are left over."""
    named = [part for part in parts if part.partition("=")[0] in _NAMED and "=" in part]
    known = {key: value for key, _, value in (part.partition("=") for part in named)}
    waiting = [level for level in levels if level not in known]
    free = [part.partition("=")[2] or part for part in parts if part not in named]
    for level, part in zip(waiting, free, strict=False):
        known[level] = part
    return known, free[len(waiting) :]
