"""When something set in: the moment from which an effect acts, or a parameter is another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray
from nxt_twin.diagnose.diagnosis import Onset
from nxt_twin.diagnose.fitting.linear import Linear

_LEAST_NATS = 8.0  # nats that the best moment has to gain
_SURE = 0.02  # largest p-value of an onset
_WITHIN_NATS = 2.0  # nats: moments that are less likely than the best by less lie within its bounds
_MARGIN_S = 0.5  # s from either end of a recording in which no moment is tried
_LONGEST_INTERVAL_S = 2.0  # s between the bounds: a moment that is less sure is no onset
_ENDS_S, _ENDS_SHARE = (
    1.5,
    0.125,
)  # a best moment so near an end tells of a beginning or an end, not of a change
_GRID = 400  # moments tried in a recording at most
_SHIFTS = 60  # shifts of the innovations in time, for the second p-value
_ABSENT = (-2.5, -0.4)


@final
@dataclass(frozen=True)
class Direction:
    """Something that may act in one part of a recording only.

    Attributes:
        what: an effect's id or a parameter's name.
        signature: what it does to the readings, shape (readings,).
        found: it is in the structure already, so the question is whether it was absent at first.
    """

    what: str
    signature: FloatArray
    found: bool


def onsets(linear: Linear, directions: Sequence[Direction], clean: FloatArray) -> tuple[Onset, ...]:
    """Moments at which one of `directions` set in, at most one a recording, the strongest first.

    A structural change test: the direction, cut off before (or after) each moment, is weighed with everything that
    the re-fit can take up projected out. The p-value compares the best moment of a recording with two
    references: `clean` cases, shape (cases, readings), and these readings' own innovations shifted in time.
    The second is needed because physics that is always missing also gathers at some moment.
    """
    names = np.array([job.signals.name for job in linear.jobs])[linear.run]
    found = []
    for name in dict.fromkeys(names):
        mine = np.flatnonzero(names == name)
        order = mine[np.argsort(linear.time_s[mine], kind="stable")]
        best = [_best_moment(linear, direction, order, clean) for direction in directions]
        named = [(onset, direction) for onset, direction in zip(best, directions, strict=True) if onset]
        if not named:
            continue
        (time_s, low_s, high_s, nats, p_value), direction = max(named, key=lambda one: one[0][3])
        found.append(Onset(direction.what, str(name), time_s, low_s, high_s, nats, p_value))
    return tuple(sorted(found, key=lambda onset: -onset.strength))


def _best_moment(
    linear: Linear, direction: Direction, order: IntArray, clean: FloatArray
) -> tuple[float, float, float, float, float] | None:
    """The likeliest moment with its bounds, s, its nats and its p-value; None where there is no such moment."""
    times_s = linear.time_s[order]
    grid = np.unique(np.linspace(0, order.size - 1, min(_GRID, order.size)).astype(int))
    inside: BoolArray = (times_s[grid] > times_s[0] + _MARGIN_S) & (times_s[grid] < times_s[-1] - _MARGIN_S)
    grid = grid[inside]
    if grid.size < 3:
        return None
    part = direction.signature[order]
    slopes = linear.slopes[:, order]
    normal = (
        linear.slopes @ linear.slopes.T + np.diag(linear.tightness) + 1e-9 * np.eye(linear.tightness.size)
    )
    until = np.cumsum(slopes * part, axis=1)[:, grid - 1]
    strength = np.cumsum(part**2)[grid - 1]
    if not direction.found:
        until = np.sum(slopes * part, axis=1)[:, None] - until
        strength = np.sum(part**2) - strength
    taken = np.linalg.solve(normal, until)
    left = strength - np.sum(until * taken, axis=0)
    told = left > 1e-6 * np.maximum(strength, 1e-12)

    def score(innovations: FloatArray) -> FloatArray:
        along = np.cumsum(innovations[:, order] * part, axis=1)
        here = along[:, grid - 1] if direction.found else along[:, -1:] - along[:, grid - 1]
        return np.asarray(here - (innovations @ linear.slopes.T) @ taken)

    own = score(linear.innovations[None])[0]
    nats = np.where(told, 0.5 * own**2 / np.maximum(left, 1e-12), 0.0)
    if direction.found:
        share = own / np.maximum(left, 1e-12)
        nats = np.where((share > _ABSENT[0]) & (share < _ABSENT[1]), nats, 0.0)
    best = int(np.argmax(nats))
    near = np.flatnonzero(nats > nats[best] - _WITHIN_NATS)
    low_s, high_s = float(times_s[grid[near[0]] - 1]), float(times_s[grid[near[-1]]])
    if nats[best] < _LEAST_NATS or high_s - low_s > _LONGEST_INTERVAL_S:
        return None
    ends_s = min(_ENDS_S, _ENDS_SHARE * float(times_s[-1] - times_s[0]))
    if not times_s[0] + ends_s < times_s[grid[best]] < times_s[-1] - ends_s:
        return None
    p_value = 0.0
    for others in (clean, _shifted(linear.innovations)):  # the second only for what the first lets pass
        chance = np.max(np.where(told, 0.5 * score(others) ** 2 / np.maximum(left, 1e-12), 0.0), axis=1)
        p_value = max(p_value, (1.0 + float(np.sum(chance >= nats[best]))) / (1.0 + len(others)))
        if p_value > _SURE:
            return None
    return float(times_s[grid[best]]), low_s, high_s, float(nats[best]), p_value


def _shifted(innovations: FloatArray) -> FloatArray:
    """The innovations moved on by so many shares of their length, shape (shifts, readings)."""
    steps = np.linspace(0.0, innovations.size, _SHIFTS + 2)[1:-1].astype(int)
    return np.array([np.roll(innovations, step) for step in steps])
