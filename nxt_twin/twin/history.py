"""The last while of a motor, as a recording to diagnose; and what keeps a whole session."""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, Protocol, final

import numpy as np

from nxt_twin.recording.columns import BATTERY, TIME, Port, mode_column, power_column, tacho_column
from nxt_twin.recording.recording import Recording
from nxt_twin.twin.bridge import COAST, Hold

_COUNTS_MOST = 12_000
_HOLDS_MOST = 6_000
_PARTS_MOST = 100
_NONE = float("nan")


class _Held(NamedTuple):
    time_s: float
    power_pct: float
    mode: int


class _Counted(NamedTuple):
    time_s: float
    tacho_deg: float


@final
class History:
    """Commands and counts of one motor, at the times at which they acted and were taken.

    Args:
        port: of the motor.
        counts_most: how many counts to keep; older ones are forgotten.
    """

    def __init__(self, port: Port, counts_most: int = _COUNTS_MOST) -> None:
        self._port = port
        self._held: deque[_Held] = deque(maxlen=_HOLDS_MOST)
        self._counted: deque[_Counted] = deque(maxlen=counts_most)
        self._parted: deque[float] = deque(maxlen=_PARTS_MOST)

    def command(self, at_s: float, holds: Sequence[Hold]) -> None:
        """From `at_s` on the bridge does these."""
        while self._held and self._held[-1].time_s >= at_s:
            self._held.pop()
        self._held.extend(_Held(at_s + hold.after_s, 100.0 * hold.duty, hold.mode) for hold in holds)

    def count(self, taken_s: float, count: int) -> None:
        """A count was taken."""
        if not self._counted or taken_s > self._counted[-1].time_s:
            self._counted.append(_Counted(taken_s, float(count)))

    def held(self, from_s: float) -> list[tuple[float, Hold]]:
        """The bridge's state from a moment on, and its beginning."""
        before = [row for row in self._held if row.time_s <= from_s][-1:]
        since = [row for row in self._held if row.time_s > from_s]
        return [
            (max(row.time_s, from_s), Hold(0.0, row.power_pct / 100.0, row.mode)) for row in (*before, *since)
        ]

    def part(self, at_s: float) -> None:
        """Something happened at a moment that is not known well: what follows is better not tied to what was before."""
        self._parted.append(at_s)

    def clear(self) -> None:
        """Forget what was counted: it is not to be compared with what comes."""
        self._counted.clear()
        self._parted.clear()

    def seconds_since(self, from_s: float) -> float:
        """How long a recording from then on would be, s; of one that is in parts, its longest, or half of it all."""
        if not self._counted:
            return 0.0
        began_s, ended_s = self._longest(from_s)
        first_s, last_s = self._span(from_s)
        return max(ended_s - began_s, 0.5 * (last_s - first_s))

    def _span(self, from_s: float) -> tuple[float, float]:
        return max(from_s, self._counted[0].time_s), self._counted[-1].time_s

    def _longest(self, from_s: float) -> tuple[float, float]:
        """The longest part."""
        first_s, last_s = self._span(from_s)
        ends = [first_s, *(at_s for at_s in self._parted if first_s < at_s < last_s), last_s]
        return max(itertools.pairwise(ends), key=lambda part: part[1] - part[0])

    def recording(self, from_s: float, open_v: Callable[[float], float]) -> Recording:
        """The kept rows from `from_s` on, or their longest part if that is more than half of them.

        Duties are those of the bridge, so not always whole percents. The battery's column has the voltage
        without load. `open_v` gives it for the recording's first moment, so a drain is left to be found.
        """
        (low_s, high_s), (first_s, last_s) = self._longest(from_s), self._span(from_s)
        if high_s - low_s < 0.5 * (last_s - first_s):
            low_s, high_s = first_s, last_s
        counted = [row for row in self._counted if low_s <= row.time_s <= high_s]
        first_s, last_s = counted[0].time_s, counted[-1].time_s
        before = [row for row in self._held if row.time_s <= first_s]
        in_force = (
            _Held(first_s, before[-1].power_pct, before[-1].mode) if before else _Held(first_s, 0.0, COAST)
        )
        held = [row for row in self._held if first_s < row.time_s <= last_s]
        # Where both fall together the count comes first: it was read before the command could act.
        rows = [
            (*in_force, _NONE),
            *((row.time_s, _NONE, _NONE, row.tacho_deg) for row in counted),
            *((*row, _NONE) for row in held),
        ]
        rows[1:] = sorted(rows[1:], key=lambda row: row[0])
        time_s, power_pct, mode, tacho_deg = np.array(rows).T
        columns = {
            TIME: time_s,
            power_column(self._port): power_pct,
            mode_column(self._port): mode,
            tacho_column(self._port): tacho_deg,
            BATTERY: np.where(np.isfinite(tacho_deg), open_v(first_s), _NONE),
        }
        return Recording("live", columns)


class Recorder(Protocol):
    """Keeps a session as a recording; `nxt_twin.recording.stream.RecordingWriter` is one."""

    def row(self, values: Mapping[str, float]) -> None:
        """Keep one poll: a recording's columns by name, modes as indices; what was not sampled is left out."""
        ...

    def close(self) -> None:
        """The session is over."""
        ...
