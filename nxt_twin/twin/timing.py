"""When, between a request and its reply, the brick did what was asked, and how well that is known."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple, final

from nxt_twin.twin.settings import Pace

_LATE = 1.5
"""A round trip this many times as long as usual says little of when the brick acted within it."""
_STALL_S = 0.02
"""By how much longer than usual a round trip takes when the host, or the link, stood still."""
_LEARNT = 0.02
_FIRST = 20
"""Round trips after which the usual one is known."""


class Moment(NamedTuple):
    """When the brick acted.

    Attributes:
        at_s: the likeliest moment.
        std_s: its standard deviation.
        late: whether the round trip was far longer than usual.
        stall_s: by how much, where the host or the link stood still; else 0.
    """

    at_s: float
    std_s: float
    late: bool
    stall_s: float


@final
class Timing:
    """Learns how long a round trip usually takes, and dates what happens in one.

    Args:
        pace: of the link.
    """

    def __init__(self, pace: Pace) -> None:
        self._pace = pace
        self._usual_s = 0.0
        self._seen = 0

    @property
    def usual_s(self) -> float:
        """About the median of the round trips so far, s."""
        return self._usual_s

    def moment(self, sent_s: float, received_s: float) -> Moment:
        """Date what was asked at `sent_s` and answered at `received_s`."""
        trip_s, usual_s = received_s - sent_s, self._usual_s
        self._learn(trip_s)
        exact = (
            self._pace.share_std == 0.0
        )  # of a recording, in which a round trip is what passed between rows
        if exact or self._seen <= _FIRST or trip_s <= _LATE * usual_s:
            pace = self._pace
            return Moment(sent_s + pace.share * trip_s, pace.share_std * trip_s, late=False, stall_s=0.0)
        stall_s = trip_s - usual_s
        return Moment(
            sent_s + 0.5 * trip_s,
            trip_s / math.sqrt(12.0),
            late=True,
            stall_s=stall_s if stall_s > _STALL_S else 0.0,
        )

    def presumed(self, sent_s: float) -> Moment:
        """Date what was asked at `sent_s` and never answered: as in a usual round trip, if at all."""
        trip_s, pace = self._usual_s, self._pace
        return Moment(sent_s + pace.share * trip_s, pace.share_std * trip_s, late=True, stall_s=0.0)

    def _learn(self, trip_s: float) -> None:
        """A step towards each round trip, of a size that does not depend on how far off it is: the median's way."""
        self._seen += 1
        if self._seen <= _FIRST:
            self._usual_s += (trip_s - self._usual_s) / self._seen
        elif trip_s > self._usual_s:
            self._usual_s *= 1.0 + _LEARNT
        else:
            self._usual_s *= 1.0 - _LEARNT


@final
@dataclass
class Stalls:
    """How often the host or the link stood still.

    Attributes:
        count: so often.
        longest_s: the longest of them.
    """

    count: int = 0
    longest_s: float = 0.0

    def add(self, stall_s: float) -> None:
        """One more."""
        self.count += 1
        self.longest_s = max(self.longest_s, stall_s)

    def words(self) -> str:
        """For a person; empty where there were none."""
        if not self.count:
            return ""
        times = "once" if self.count == 1 else f"{self.count} times"
        return f"the host or the link stood still {times}, for {1e3 * self.longest_s:.0f} ms at most"
