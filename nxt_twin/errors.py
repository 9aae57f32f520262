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
        place = f"{where}: " if where else ""
        remedy = f" ({mend})" if mend else ""
        super().__init__(" ".join(f"{place}{what}{remedy}".split()))


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
