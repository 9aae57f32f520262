"""What looking for bricks finds: bricks, or the reasons why there are none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from nxt_twin.brick.errors import BrickError, LinkRefusedError, Refusal


@final
@dataclass(frozen=True)
class FoundBrick:
    """A brick that can be opened.

    Attributes:
        url: what to open it by.
        what: what is known of it without opening it.
    """

    url: str
    what: str


@final
@dataclass(frozen=True)
class Reason:
    """Why a way led to no brick, or not to one that is there.

    Attributes:
        what: the obstacle.
        cause: its kind; None where the search itself went wrong.
        mend: what to do about it; may be empty.
    """

    what: str
    cause: Refusal | None
    mend: str = ""


@final
@dataclass(frozen=True)
class WayReport:
    """What one way led to; without bricks there is at least one reason.

    Attributes:
        way: the way's name, such as ``usb``.
        bricks: those that can be opened.
        reasons: why there are no others.
    """

    way: str
    bricks: tuple[FoundBrick, ...] = ()
    reasons: tuple[Reason, ...] = ()


def reason_of(error: BrickError) -> Reason:
    """The reason that an error gives."""
    place = f"{error.where}: " if error.where else ""
    cause = error.cause if isinstance(error, LinkRefusedError) else None
    return Reason(f"{place}{error.what}", cause, error.mend)
