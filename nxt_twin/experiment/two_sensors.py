"""Which opening of an ultrasonic sensor speaks and which listens, and where they are, from a strip slid over them.

Covered, the receiver hears nothing; covered, the emitter is still replaced by another sensor's pings. So alone the
echo is gone at both openings, together with a second sensor only at the receiver's.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.experiment.errors import ExperimentError
from nxt_twin.experiment.folder import RunFolder
from nxt_twin.experiment.identified import Identified
from nxt_twin.experiment.plan import TwoSensors
from nxt_twin.experiment.posterior import weighed
from nxt_twin.experiment.sweep import sweep_of
from nxt_twin.recording.recording import Recording
from nxt_twin.sensors.ultrasonic import NO_ECHO

_FINE: Final = 8
"""Places tried for an edge between two places of the strip."""
_LEAST_CHANCE: Final = 1e-3
_MOST_PLACES: Final = 400


def identify_two_sensors(experiment: TwoSensors, folder: RunFolder) -> Identified:
    """Find the openings.

    Raises:
        ExperimentError: no echo was ever lost, or none ever heard.
    """
    return identified_from(experiment, [folder.read(part.name) for part in sweep_of(experiment).parts])


def identified_from(experiment: TwoSensors, recordings: Sequence[Recording]) -> Identified:
    """The same from the recordings `alone` and `together`."""
    column = sweep_of(experiment).column
    alone, together = (_counts(recording, column) for recording in recordings)
    receiver = _shadow(*together, "together")
    emitter = _shadow(*_without(alone, receiver), "alone")
    places = {
        "receiver_mm": weighed("receiver_mm", *_middle(receiver), "mm"),
        "emitter_mm": weighed("emitter_mm", *_middle(emitter), "mm"),
        "shadow_mm": weighed("shadow_mm", *_width(receiver), "mm"),
    }
    side = "left" if places["receiver_mm"].value < places["emitter_mm"].value else "right"
    apart = abs(places["emitter_mm"].value - places["receiver_mm"].value)
    note = (
        f"The receiver is the {side} opening as one looks at the face, the emitter the other one;"
        f" they are {apart:.1f} mm apart."
    )
    config = {"kind": "ultrasonic_sensor", "transducer_spacing_mm": round(apart, 3)}
    return Identified(experiment.kind, tuple(places.values()), (), (note,), config)


Counts = tuple[FloatArray, FloatArray, FloatArray]
"""Places of the strip, readings with an echo there, readings in all; shape (places,) each."""

Posterior = tuple[FloatArray, FloatArray, FloatArray]
"""Left edges, right edges and the logarithm of their probability; shape (pairs,) each."""


def _counts(recording: Recording, column: str) -> Counts:
    place, reading = recording.columns["rig_position_mm"], recording.columns[column]
    places = np.unique(place)
    heard = np.array([np.count_nonzero(reading[place == p] < NO_ECHO) for p in places], dtype=np.float64)
    return places, heard, np.array([np.count_nonzero(place == p) for p in places], dtype=np.float64)


def _without(counts: Counts, receiver: Posterior) -> Counts:
    """What was read where the strip was certainly not on the receiver."""
    places, heard, total = counts
    left, right, chance = receiver
    likely = chance > chance.max() - 12.0
    free = (places < left[likely].min()) | (places > right[likely].max())
    return places[free], heard[free], total[free]


def _shadow(places: FloatArray, heard: FloatArray, total: FloatArray, name: str) -> Posterior:
    """Where one shadow begins and ends: for each pair of edges, how likely it makes what was heard.

    The chances of an echo inside and outside are taken at their likeliest for each pair.
    """
    if not 10 <= places.size <= _MOST_PLACES or heard.sum() == 0.0:
        what = "no reading has an echo" if heard.sum() == 0.0 else f"{places.size} places are of no use"
        raise ExperimentError(what, where=name, mend="check the sensor and the range of the strip's places")
    step = float(np.median(np.diff(places)))
    # Never at a place itself: an edge there would count as beyond it, and all edges be late by half a fine step.
    edges = np.arange(places[0] - 0.5 * step, places[-1] + 0.5 * step, step / _FINE) + 0.5 * step / _FINE
    # How many of the places lie below an edge, and what was read there; an interval is a difference.
    below = np.searchsorted(places, edges)
    heard_below = np.concatenate([[0.0], np.cumsum(heard)])[below]
    total_below = np.concatenate([[0.0], np.cumsum(total)])[below]
    first, last = np.triu_indices(edges.size, 1)
    inside = heard_below[last] - heard_below[first], total_below[last] - total_below[first]
    outside = heard.sum() - inside[0], total.sum() - inside[1]
    rate_in, rate_out = (_rate(*part) for part in (inside, outside))
    chance = _log_chance(*inside, rate_in) + _log_chance(*outside, rate_out)
    chance = np.where((rate_in < rate_out) & (inside[1] > 0.0), chance, -np.inf)
    plain = _log_chance(heard.sum(), total.sum(), _rate(heard.sum(), total.sum()))
    if not chance.max() > plain + 10.0:
        mend = "slide a wider strip over both openings, close to the face"
        raise ExperimentError("the strip never kept an echo away", where=name, mend=mend)
    return edges[first], edges[last], chance


def _rate(heard: FloatArray | float, total: FloatArray | float) -> FloatArray:
    return np.asarray(np.clip(heard / np.maximum(total, 1.0), _LEAST_CHANCE, 1.0 - _LEAST_CHANCE))


def _log_chance(heard: FloatArray | float, total: FloatArray | float, rate: FloatArray) -> FloatArray:
    return np.asarray(heard * np.log(rate) + (total - heard) * np.log1p(-rate))


def _middle(posterior: Posterior) -> tuple[FloatArray, FloatArray]:
    return 0.5 * (posterior[0] + posterior[1]), posterior[2]


def _width(posterior: Posterior) -> tuple[FloatArray, FloatArray]:
    return posterior[1] - posterior[0], posterior[2]
