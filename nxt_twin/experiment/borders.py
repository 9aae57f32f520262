"""Where an ultrasonic sensor's near range begins and ends: every place for a border is weighed.

A sharp border is equally likely at every point between two visited places. So there is no likeliest point, and no
curvature that gives a standard deviation. The sensor's line and noise are taken as fitted.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np
from scipy.special import logsumexp

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.experiment.identified import Value
from nxt_twin.experiment.posterior import weighed
from nxt_twin.sensors import ultrasonic
from nxt_twin.sensors.intervals import logistic

_OFFSETS: Final = np.linspace(-60.0, 60.0, 121)
_SHARES: Final = np.linspace(0.02, 1.0, 50)
_IN_A_GAP: Final = 16
"""Places for a border that are tried between two places of the target."""
_SHARPNESS: Final = np.geomspace(0.05, 2.0, 5)
_LEAST: Final = 1e-280


def blind_border(
    parameters: ultrasonic.UltrasonicParameters, distance_mm: FloatArray, readings: FloatArray
) -> Value:
    """Below which distance nothing is measured, whatever the border's width.

    Args:
        parameters: as fitted.
        distance_mm: of the target, shape (readings,).
        readings: cm, shape (readings,).
    """
    silent = readings >= ultrasonic.NO_ECHO
    places = np.unique(distance_mm)
    first, last = np.searchsorted(places, [distance_mm[~silent].min(), distance_mm[silent].max()])
    tried, _ = _between(places[max(min(first, last) - 3, 0) : max(first, last) + 4])
    widths = _SHARPNESS[:, None, None] * parameters.blind_edge_mm
    lost = (tried[None, :, None] - distance_mm) / widths
    chance = np.log(np.maximum(logistic(np.where(silent, lost, -lost)), _LEAST)).sum(axis=2)
    return weighed("blind_distance_mm", tried, logsumexp(chance, axis=0), "mm")


@final
@dataclass(frozen=True)
class NearOffset:
    """An offset at short range, its share of the echoes and where it ends, all weighed together.

    Attributes:
        places: distances of the target that were visited, mm, shape (places,).
        gained: what an offset up to a border gains, nats, shape (shares, offsets, places - 1); the border lies
            between two places.
    """

    places: FloatArray
    gained: FloatArray

    def likeliest(self, parameters: ultrasonic.UltrasonicParameters) -> ultrasonic.UltrasonicParameters:
        """The parameters with the likeliest offset, share and border."""
        share, offset, gap = np.unravel_index(int(np.argmax(self.gained)), self.gained.shape)
        return replace(
            parameters,
            near_offset_mm=float(_OFFSETS[offset]),
            near_share=float(_SHARES[share]),
            near_below_mm=float(0.5 * (self.places[gap] + self.places[gap + 1])),
        )

    def values(self) -> tuple[Value, Value, Value]:
        """The three with their doubts."""
        by_gap = self.gained + np.log(np.diff(self.places))
        tried, gap = _between(self.places)
        return (
            weighed("near_offset_mm", _OFFSETS, logsumexp(by_gap, axis=(0, 2)), "mm"),
            weighed("near_share", _SHARES, logsumexp(by_gap, axis=(1, 2)), ""),
            weighed("near_below_mm", tried, logsumexp(self.gained, axis=(0, 1))[gap], "mm"),
        )


def near_offset(
    parameters: ultrasonic.UltrasonicParameters,
    distance_mm: FloatArray,
    readings: FloatArray,
    highest_mm: float,
) -> NearOffset:
    """Weigh every near offset.

    Args:
        parameters: line and noise.
        distance_mm: of the target where an echo was heard, shape (readings,).
        readings: cm, shape (readings,).
        highest_mm: the offset ends below this; at least two places are.
    """
    near = np.flatnonzero(distance_mm < highest_mm)
    near = near[np.argsort(distance_mm[near], kind="stable")]
    truth, seen = ultrasonic.UltrasonicTruth(distance_mm[near]), readings[near]
    plain = replace(parameters, near_share=0.0, blind_distance_mm=0.0)
    without = ultrasonic.reading_probability(plain, seen, truth)
    moved = (replace(plain, zero_mm=plain.zero_mm + float(offset)) for offset in _OFFSETS)
    shifted = np.array([ultrasonic.reading_probability(each, seen, truth) for each in moved])
    places, count = np.unique(truth.distance_mm, return_counts=True)
    last = np.cumsum(count)[:-1] - 1
    lacking = np.log(np.maximum(without, _LEAST))

    def gained(share: float) -> FloatArray:
        mixed = (1.0 - share) * without + share * shifted
        return np.cumsum(np.log(np.maximum(mixed, _LEAST)) - lacking, axis=1)[:, last]

    return NearOffset(places, np.stack([gained(share) for share in _SHARES]))


def _between(places: FloatArray) -> tuple[FloatArray, IntArray]:
    """Borders to try between neighbouring places, evenly in each gap, and the number of the gap of each.

    Where gaps differ in width, each is tried as often as it is wide.
    """
    gaps = np.diff(places)
    count = np.maximum(np.rint(_IN_A_GAP * gaps / np.mean(gaps)).astype(np.int64), 1)
    gap = np.repeat(np.arange(gaps.size), count)
    within = np.concatenate([(np.arange(n) + 0.5) / n for n in count])
    return places[gap] + within * gaps[gap], gap
