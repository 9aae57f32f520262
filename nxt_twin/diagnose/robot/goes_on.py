"""Errors of place that go on from second to second: an unknown law that is smooth, such as a bent picture.

The noise of a pose turns a second's error against the next one's, as both share the pose between them. Slip by chance
leaves them independent. Only a law that goes on makes them alike, and known effects leave none.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.robot.leftover import LEAST_M, RobotLeft, ShortErrors, base_columns, clipped, scale_of

GOES_ON_NATS: Final = 3.0
"""The gain from letting an error go on. Bent pictures have 4.0 or more (seeds 821 to 828), known effects less than 0
(seeds 700 to 776)."""

_FEWEST_PAIRS: Final = 20  # of neighbouring seconds, below which no error is said to go on
_MOVES_M: Final = 0.02  # travel in a second from which a robot goes ahead or back
_PLACE: Final = (0, 1)
"""Errors along and sideways; a turn's are those of the pose's heading."""


def what_goes_on(short: ShortErrors) -> list[RobotLeft]:
    """The errors of place, where those of neighbouring seconds of one way of driving are alike; else none."""
    pairs = _neighbours(short)
    if int(np.count_nonzero(pairs)) < _FEWEST_PAIRS:
        return []
    base = base_columns(short)
    rest = [_without(base, clipped(short.scores[channel])) for channel in _PLACE]
    unit = scale_of(short)
    shared, found = _shared(rest, pairs)
    amount = max(
        float(unit[channel] * np.std(one)) for channel, one in zip(_PLACE, rest, strict=True)
    ) * float(np.sqrt(max(shared, 0.0)))
    if shared <= 0.0 or found <= GOES_ON_NATS or amount <= LEAST_M:
        return []
    return [RobotLeft("error of the second before", "along", found, shared, amount)]


def _shared(rest: list[FloatArray], pairs: BoolArray) -> tuple[float, float]:
    """The share of the variance that neighbours have in common, and its gain in nats."""
    one = np.concatenate([errors[:-1][pairs] / np.std(errors) for errors in rest])
    other = np.concatenate([errors[1:][pairs] / np.std(errors) for errors in rest])
    shared = float(one @ other / np.sqrt((one @ one) * (other @ other)))
    return shared, -0.5 * one.size * float(np.log1p(-(shared**2)))


def _neighbours(short: ShortErrors) -> BoolArray:
    """Which seconds are followed by another of the run that goes the way of the first, shape (windows - 1,)."""
    way = np.sign(short.travel_m) * (np.abs(short.travel_m) > _MOVES_M)
    return np.asarray((short.run[1:] == short.run[:-1]) & (way[1:] * way[:-1] > 0.0))


def _without(base: FloatArray, scores: FloatArray) -> FloatArray:
    return np.asarray(scores - base @ np.linalg.lstsq(base, scores, rcond=None)[0])
