"""An arm's other joints: the stretches in which they rest, and by how much they tilt the joint in question."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import degrees, radians

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import RecordingError
from nxt_twin.recording.recording import GOALS, Recording

_STILL_RAD = radians(1.0)
_SHORTEST_S = 2.0


def stretches_at_rest(
    recording: Recording, angles: Mapping[str, FloatArray], signs: Mapping[str, float]
) -> tuple[Recording, ...]:
    """The stretches of a recording in which all other joints rest, with angles counted from the arm's foot.

    Gravity acts on a joint by its own angle and those of the joints that carry it. Where these rest, their sum is a
    constant: added to reading and goal, it leaves the motion as it is and gives all stretches one phase.

    Args:
        recording: of the joint in question; its output is an angle.
        angles: of the other joints, rad, shape (rows,) each; NaN where not sampled.
        signs: by how much each one's angle adds to this joint's; 0 where it only has to rest.

    Raises:
        RecordingError: the other joints never rest for two seconds; the text says which of them moved.
    """
    filled = {name: _filled(values) for name, values in angles.items()}
    spans = [
        (first, end)
        for first, end in _spans(list(filled.values()))
        if recording.time_s[end - 1] - recording.time_s[first] >= _SHORTEST_S
    ]
    if not spans:
        moved = ", ".join(
            f"{name} (by {degrees(np.ptp(values)):.0f} deg)"
            for name, values in filled.items()
            if np.ptp(values) > _STILL_RAD
        )
        what = f"joints move at once with this one, and never rest for {_SHORTEST_S:.0f} s: {moved}"
        mend = "move one joint at a time, or take those that do not bear on it out of `gravity_of`"
        raise RecordingError(what, where=f"{recording.name}, mapping key gravity_of", mend=mend)
    return tuple(
        _stretch(recording, span, f"~{number}" if len(spans) > 1 else "", filled, signs)
        for number, span in enumerate(spans, start=1)
    )


def _filled(values: FloatArray) -> FloatArray:
    """Cells that were not sampled, between those that were."""
    known = np.flatnonzero(np.isfinite(values))
    if not known.size:
        return np.zeros(values.size)
    return np.asarray(np.interp(np.arange(values.size), known, values[known]))


def _spans(angles: Sequence[FloatArray]) -> list[tuple[int, int]]:
    """First row and end of each stretch in which no joint leaves its angle by more than a degree."""
    rows, spans, first = angles[0].size, [], 0
    while first < rows:
        moved = np.any([np.abs(each[first:] - each[first]) > _STILL_RAD for each in angles], axis=0)
        end = first + int(np.argmax(moved)) if moved.any() else rows
        spans.append((first, max(end, first + 1)))
        first = spans[-1][1]
    return spans


def _stretch(
    recording: Recording,
    span: tuple[int, int],
    mark: str,
    angles: Mapping[str, FloatArray],
    signs: Mapping[str, float],
) -> Recording:
    rows = slice(*span)
    tilt = sum(signs[name] * float(np.median(values[rows])) for name, values in angles.items())
    columns = {name: np.array(values[rows]) for name, values in recording.columns.items()}
    columns["output"] += tilt
    if recording.kinds is not None and recording.kinds.input in GOALS:
        columns["input"] += tilt
    return replace(recording, name=f"{recording.name}{mark}", columns=columns)
