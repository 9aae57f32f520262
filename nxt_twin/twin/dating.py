"""When what stands in a row was read and what was commanded after it acted, by the round trips of both."""

from __future__ import annotations

from typing import Any, final

from nxt_twin.brick.stamped import Stamped
from nxt_twin.recording.columns import Port
from nxt_twin.recording.lags import RowLags
from nxt_twin.twin.settings import Pace
from nxt_twin.twin.timing import Timing


@final
class Dating:
    """Dates replies, and learns by how much they are off the stamps of their rows; all by one clock, s.

    Args:
        pace: when, between request and reply, the brick acts.

    Attributes:
        row_lags: what was learnt.
    """

    def __init__(self, pace: Pace) -> None:
        self._pace = pace
        self._timing = Timing(pace)
        self.row_lags = RowLags()

    def count(self, port: Port, reply: Stamped[Any]) -> None:
        """A motor's count for the row to come was read."""
        taken = self._timing.moment(reply.sent_s, reply.received_s)
        self.row_lags.taken(port, taken.at_s - self._pace.count_age_s, taken.std_s)

    def row(self, stamp_s: float) -> None:
        """The row with what was read has this stamp."""
        self.row_lags.row(stamp_s)

    def command(self, port: Port, reply: Stamped[Any], stamp_s: float) -> None:
        """A motor was commanded, which is written into the row of this stamp."""
        taken = self._timing.moment(reply.sent_s, reply.received_s)
        self.row_lags.acted(port, taken.at_s + self._pace.command_lag_s - stamp_s, taken.std_s)
