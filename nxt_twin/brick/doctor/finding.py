"""The findings of checks of this machine."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import final


class Severity(StrEnum):
    """How bad it is: fail closes at least one way to a brick, warn may."""

    OK = "ok"
    WARN = "warn"
    FAIL = "fail"


@final
@dataclass(frozen=True)
class Finding:
    """One line of the doctor's report.

    Attributes:
        check: what was looked at.
        verdict: how bad it is.
        what: what is the case.
        why: what it means for reaching a brick; empty where all is well.
        mend: the command or step that puts it right; empty where all is well.
    """

    check: str
    verdict: Severity
    what: str
    why: str = ""
    mend: str = ""
