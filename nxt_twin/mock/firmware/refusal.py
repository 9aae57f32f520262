"""How a command's handler says no."""

from __future__ import annotations

from typing import final

from firmware_protocol import ReplyData, Status


@final
class Refusal(Exception):  # noqa: N818 - a refusal is what it is
    """A reply with a status other than OK.

    Args:
        status: why.
        data: what the firmware sends behind it, if anything.
    """

    def __init__(self, status: Status, data: ReplyData | None = None) -> None:
        self.status = status
        self.data = data
        super().__init__(status.text)
