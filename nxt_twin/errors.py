"""Every failure the tool names, as one tree.

    NxtTwinError
    ├── RecordingError     a recording that cannot be read as one
    ├── MappingError       a mapping file that does not describe its table
    ├── CaseError          a case folder that is not one
    ├── PlantError         a plant configuration that is not one
    ├── DiagnosisError     recordings from which nothing can be concluded
    ├── ProgramError       a program or experiment file that is not one
    └── MissingDataError   data that the user has to fetch first

The text of each is one line: what is wrong, where, and what to do.
"""

from __future__ import annotations

from typing import Final

LONGEST_LINE: Final = 280
"""What the text of a failure holds at most: files and arguments that others made are quoted in it."""


class NxtTwinError(Exception):
    """Something the user can mend.

    Args:
        what: what is wrong.
        where: the file, row, column or key, if there is one.
        mend: what to do about it.
    """

    def __init__(self, what: str, *, where: str = "", mend: str = "") -> None:
        self.what = what
        self.where = where
        self.mend = mend
        place, wrong, remedy = _within(
            LONGEST_LINE, *(" ".join(part.split()) for part in (where, what, mend))
        )
        super().__init__(f"{place}: " * bool(place) + wrong + f" ({remedy})" * bool(remedy))


def _within(longest: int, where: str, what: str, mend: str) -> tuple[str, str, str]:
    """The three, each cut no more than it must be so that all fit; of a place the end is kept, which names the row."""
    lengths = [len(where), len(what), len(mend)]
    room = longest - len(": ") - len(" ()")
    for waiting, index in zip((3, 2, 1), sorted(range(3), key=lengths.__getitem__), strict=True):
        lengths[index] = min(lengths[index], room // waiting)
        room -= lengths[index]
    at, wrong, mended = lengths
    return (
        where if len(where) <= at else f"…{where[len(where) - at + 1 :]}",
        what if len(what) <= wrong else f"{what[: wrong - 1]}…",
        mend if len(mend) <= mended else f"{mend[: mended - 1]}…",
    )


class RecordingError(NxtTwinError):
    """A recording that cannot be read as one: wrong columns, cells or order."""


class MappingError(NxtTwinError):
    """A mapping file that does not describe its table."""


class CaseError(NxtTwinError):
    """A case folder that is incomplete or names what is not there."""


class PlantError(NxtTwinError):
    """A plant configuration with a wrong kind, key, value or unit."""


class DiagnosisError(NxtTwinError):
    """Recordings from which nothing can be concluded."""


class ProgramError(NxtTwinError):
    """A motor program or an experiment with a wrong key or value."""


class MissingDataError(NxtTwinError):
    """Data that is not on this machine and that the user has to fetch."""
