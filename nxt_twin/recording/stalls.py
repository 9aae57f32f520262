"""Where the host or the link stood still while a recording was made: a row's stamp then says little of its readings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.recording.clumps import clump_ends
from nxt_twin.recording.recording import Recording

_LEAST_S: Final = 0.02
_SPREADS: Final = 12.0
_FEWEST_ROWS: Final = 8


@final
@dataclass(frozen=True)
class Stall:
    """A wait between two rows that the recording's own pace does not explain.

    Attributes:
        row: the first one after it, from 0.
        start_s: the stamp of the row before, s.
        length_s: how much longer than usual it took, s.
    """

    row: int
    start_s: float
    length_s: float


def stalls(recording: Recording) -> tuple[Stall, ...]:
    """Every wait that is far longer than the recording's usual one.

    Usual is up to the third quartile of all waits; far is 20 ms more, and twelve times what lies between that and the
    median. So neither rows with a slow reading among them nor polls at random moments are taken for stalls. Rows that
    came in clumps waited from clump to clump.
    """
    ends = clump_ends(recording.time_s)
    rows = ends if ends.size else np.arange(recording.time_s.size)
    waits_s = np.diff(recording.time_s[rows])
    if waits_s.size < _FEWEST_ROWS:
        return ()
    middle_s, usual_s = np.quantile(waits_s, (0.5, 0.75))
    far_s = usual_s + max(_LEAST_S, _SPREADS * (usual_s - middle_s))
    return tuple(
        Stall(int(rows[n]) + 1, float(recording.time_s[rows[n]]), float(waits_s[n] - middle_s))
        for n in np.flatnonzero(waits_s > far_s)
    )


def stalled_share(recording: Recording) -> float:
    """Which share of the recording's time went by in stalls; hosts that are not busy stay below 0.03."""
    duration_s = recording.duration_s
    return sum(each.length_s for each in stalls(recording)) / duration_s if duration_s else 0.0


def stalls_in_words(found: Sequence[Stall]) -> str:
    """How often and how long, for a person; empty where there is none."""
    if not found:
        return ""
    longest = max(found, key=lambda each: each.length_s)
    often = "once" if len(found) == 1 else f"{len(found)} times"
    return (
        f"the host or the link stood still {often}, for up to {1e3 * longest.length_s:.0f} ms "
        f"(at {longest.start_s:.1f} s); readings and commands there have an unknown delay"
    )
