"""When a host gets to poll a brick."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray

LinkName = Literal["usb", "bluetooth"]

SHORTEST_S = {"usb": 0.004, "bluetooth": 0.012}
STALL_CHANCE = 0.002


def polls_s(rng: Generator, link: LinkName, duration_s: float) -> FloatArray:
    """True times of the readings, s, from 0 to about `duration_s`.

    USB: about 100 Hz with 1 ms of jitter. Bluetooth: 25 to 35 Hz with 5 to 15 ms of jitter. On both, one
    poll in 500 stalls for a tenth of a second or so.
    """
    if link == "usb":
        period_s, jitter_s = 0.010, 0.001
    else:
        period_s, jitter_s = 1.0 / rng.uniform(25.0, 35.0), rng.uniform(0.005, 0.015)
    count = int(1.5 * duration_s / period_s) + 10
    gaps_s = np.maximum(period_s + jitter_s * rng.standard_normal(count), SHORTEST_S[link])
    stalled = rng.random(count) < STALL_CHANCE
    gaps_s += np.where(stalled, rng.uniform(0.03, 0.12, count), 0.0)
    times_s = np.concatenate([[0.0], np.cumsum(gaps_s)])
    return np.round(times_s[times_s <= duration_s], 6)
