"""How a command's handler says no."""

from __future__ import annotations

from typing import final

from firmware_protocol import ReplyData, Status


@final
class RefusedReply(Exception):  # noqa: N818 - a refusal is what it is
    """A reply with a status other than OK.

    Args:
        status: why.
        data: what the firmware sends behind it, if anything.
        cut: how many bytes of that it leaves off at the end.
    """

    def __init__(self, status: Status, data: ReplyData | None = None, *, cut: int = 0) -> None:
        self.status = status
        self.data = data
        self.cut = cut
        super().__init__(status.text)
