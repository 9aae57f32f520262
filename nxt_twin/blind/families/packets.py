"""A link that hands a device's rows over in packets: the host stamps them when the packet comes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.blind.families.habits import Habits
from nxt_twin.recording.recording import Recording

_CHANCE: Final = 0.15
_LEAST_HZ: Final = 80.0
_MOST_ROWS: Final = 6
_STAMPED_ANYHOW: Final = frozenset({"clock_skew", "stale_samples", "sample_hold"})
"""With these, nobody could tell what packets do to the stamps."""


@final
@dataclass(frozen=True)
class Packets:
    """How rows are packed.

    Attributes:
        rows: in each packet, where the device counts them; 0: a timer sends what there is.
        period_polls: of that timer, in the usual time between two rows.
        transit_s: standard deviation of the time that a packet takes, s.
        apart_s: between the stamps of two rows of a packet, s.
    """

    rows: int
    period_polls: float
    transit_s: float
    apart_s: float

    def ends(self, read_s: FloatArray) -> IntArray:
        """The last row of each packet, for rows that were read at these times."""
        if self.rows:
            return np.unique(np.append(np.arange(self.rows - 1, read_s.size, self.rows), read_s.size - 1))
        return np.append(np.flatnonzero(np.diff(self._turns(read_s)) > 0.0), read_s.size - 1)

    def sent_s(self, read_s: FloatArray, ends: IntArray) -> FloatArray:
        """When each packet is sent, s."""
        if self.rows:
            return read_s[ends]
        return np.asarray((self._turns(read_s)[ends] + 1.0) * self._period_s(read_s))

    def _turns(self, read_s: FloatArray) -> FloatArray:
        return np.asarray(np.floor(read_s / self._period_s(read_s)))

    def _period_s(self, read_s: FloatArray) -> float:
        return self.period_polls * float(np.median(np.diff(read_s)))


def draw_packets(rng: Generator, habits: Habits, effects: Sequence[str]) -> Packets | None:
    """Draw the link of a case, where its rows come in packets at all."""
    if rng.random() > _CHANCE or habits.rate_hz < _LEAST_HZ or _STAMPED_ANYHOW.intersection(effects):
        return None
    counted = rng.random() < 0.5
    return Packets(
        rows=int(rng.integers(2, _MOST_ROWS + 1)) if counted else 0,
        period_polls=float(rng.uniform(2.2, _MOST_ROWS)),
        transit_s=float(rng.choice((0.0, 2e-4, 1e-3))),
        apart_s=float(rng.choice((0.0, 2e-5, 8e-5))),
    )


def handed_over(rng: Generator, recording: Recording, packets: Packets) -> Recording:
    """The recording with the stamps that its rows get when their packets come, the first one zero."""
    read_s = recording.time_s
    ends = packets.ends(read_s)
    transit_s = packets.transit_s * np.abs(rng.standard_normal(ends.size))
    came_s = np.maximum.accumulate(packets.sent_s(read_s, ends) + transit_s)
    sizes = np.diff(ends, prepend=-1)
    within = np.arange(read_s.size) - np.repeat(ends - sizes + 1, sizes)
    stamped_s = np.repeat(came_s, sizes) + packets.apart_s * within
    stamped_s = np.maximum.accumulate(stamped_s - stamped_s[0]).round(6)
    return replace(recording, columns={**recording.columns, "time_s": stamped_s})
