"""When an effect set in that has such a moment among its parameters, by following the moment's likelihood."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray
from nxt_twin.diagnose.diagnosis import Estimate, Onset
from nxt_twin.diagnose.fitting.linear import Linear
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.simulate import Simulator

_SYMBOL = "onset"  # of such a parameter, s since the session began
_WITHIN_NATS = 4.0  # twice what a likelihood without flaw would ask for
_MARGIN_S = 0.5  # s: a moment so near an end of a recording may lie outside it as well
_NORMAL_95 = 1.959964  # standard deviations to either side that hold 95 % of a normal distribution
_COARSE_S, _FINE_S = 0.25, 0.02
_FEWEST, _MOST = 20, 200
_MOST_CELLS = 2_000_000  # moments times readings
_ZOOM = 4  # times finer spacing of the moments in each round


@final
@dataclass(frozen=True)
class _Followed:
    """Moments since the session began in rising order, and how likely each is, nats; shape (moments,)."""

    at_s: FloatArray
    nats: FloatArray


def moments(simulator: Simulator, linear: Linear) -> tuple[Onset, ...]:
    """The moments of all effects in the structure that have one, each if it is surely within a recording.

    The likelihood stays flat while the plant stands or the effect does not show. The answer is the middle of
    that stretch; its bounds are the last moment before and the first moment after. What may as well have come
    between two recordings has no moment.
    """
    plant = linear.structure.plant
    slots = [Slot(effect.id, _SYMBOL) for effect in plant.effects]
    found = [_moment(simulator, linear, slot) for slot in slots if slot in plant.values]
    return tuple(onset for onset in found if onset is not None)


def with_bounds(
    simulator: Simulator, linear: Linear, effect: Effect, params: Mapping[str, Estimate]
) -> dict[str, Estimate]:
    """`params` of `effect` with the interval of its moment, if it has one, followed in the same way.

    A slope tells nothing of a moment at which the plant stood. The interval may reach over the end of a recording.
    """
    slot = Slot(effect.id, _SYMBOL)
    if slot not in linear.structure.plant.values:
        return dict(params)
    name = linear.structure.plant.layout.parameters[slot].name
    low_s, high_s = _bounds_s(simulator, linear, slot)
    std = (high_s - low_s) / (2.0 * _NORMAL_95)
    return {**params, name: replace(params[name], std=std, interval_95=(low_s, high_s))}


def _bounds_s(simulator: Simulator, linear: Linear, slot: Slot) -> tuple[float, float]:
    """Between which moments of the session the fitted one lies."""
    own_s = linear.structure.plant.values[slot]
    ends_s = max(job.signals.session_s + float(np.ptp(job.signals.time_s)) for job in linear.jobs)
    spacing_s = max(_COARSE_S, ends_s / _MOST)
    grid_s = np.append(np.arange(0.0, ends_s + spacing_s, spacing_s), own_s)
    followed = _follow(simulator, linear, slot, grid_s, None)
    while True:
        near = _piece(followed, int(np.argmin(np.abs(followed.at_s - own_s))))
        before, after = max(near[0] - 1, 0), min(near[-1] + 1, followed.at_s.size - 1)
        low_s, high_s = float(followed.at_s[before]), float(followed.at_s[after])
        if spacing_s <= _FINE_S:
            return low_s, high_s
        zoomed = [
            np.linspace(followed.at_s[one], followed.at_s[other], _ZOOM + 1)
            for one, other in ((before, near[0]), (near[-1], after))
        ]
        followed = _follow(simulator, linear, slot, np.concatenate(zoomed), followed)
        spacing_s /= _ZOOM


def _moment(simulator: Simulator, linear: Linear, slot: Slot) -> Onset | None:
    signals = {job.signals.name: job.signals for job in linear.jobs}
    spans_s = {
        name: (one.session_s, one.session_s + float(np.ptp(one.time_s))) for name, one in signals.items()
    }
    seconds = sum(high_s - low_s for low_s, high_s in spans_s.values())
    most = int(np.clip(_MOST_CELLS // linear.innovations.size, _FEWEST, _MOST))
    spacing_s = max(_COARSE_S, seconds / most)
    grid_s = [np.arange(low_s, high_s, spacing_s) for low_s, high_s in spans_s.values()]
    own_s = linear.structure.plant.values[slot]
    followed = _follow(simulator, linear, slot, np.append(np.concatenate(grid_s), own_s), None)
    tries = followed.at_s.size
    inner = _inner(followed, list(spans_s.values()))
    if not inner.any():
        return None
    best = int(np.argmax(np.where(inner, followed.nats, -np.inf)))
    if followed.nats[best] < followed.nats[_between(inner)].max(initial=-np.inf):
        return None
    best_s = float(followed.at_s[best])
    name, span_s = next((name, one) for name, one in spans_s.items() if one[0] <= best_s < one[1])
    followed = _part(followed, span_s)
    while spacing_s > _FINE_S:
        near_s = followed.at_s[_near(followed, span_s)]
        zoomed = [
            np.linspace(end_s - spacing_s, end_s + spacing_s, 2 * _ZOOM + 1) for end_s in near_s[[0, -1]]
        ]
        followed = _part(_follow(simulator, linear, slot, np.concatenate(zoomed), followed), span_s)
        spacing_s /= _ZOOM
    return _within(followed, name, span_s, tries, slot.owner)


def _part(followed: _Followed, span_s: tuple[float, float]) -> _Followed:
    inside = (followed.at_s >= span_s[0]) & (followed.at_s <= span_s[1])
    return _Followed(followed.at_s[inside], followed.nats[inside])


def _inner(followed: _Followed, spans_s: Sequence[tuple[float, float]]) -> BoolArray:
    """Moments well within a recording: at its ends it is the same as between two."""
    inside = [
        (followed.at_s > low_s + _MARGIN_S) & (followed.at_s < high_s - _MARGIN_S)
        for low_s, high_s in spans_s
    ]
    return np.asarray(np.any(inside, axis=0))


def _between(inner: BoolArray) -> BoolArray:
    """Moments about the end of one recording and the beginning of the next."""
    first, last = np.flatnonzero(inner)[[0, -1]]
    number = np.arange(inner.size)
    return np.asarray(~inner & (number > first) & (number < last))


def _within(
    followed: _Followed, name: str, span_s: tuple[float, float], tries: int, what: str
) -> Onset | None:
    """The onset, where the readings of its recording say that it was neither there before nor came after."""
    inside = _near(followed, span_s)
    if inside[0] == 0 or inside[-1] == followed.at_s.size - 1:
        return None
    strength = float(max(followed.nats[inside].max() - max(followed.nats[0], followed.nats[-1]), 0.0))
    low_s, high_s = followed.at_s[inside[0] - 1] - span_s[0], followed.at_s[inside[-1] + 1] - span_s[0]
    return Onset(
        what=what,
        recording=name,
        time_s=float(0.5 * (low_s + high_s)),
        low_s=float(low_s),
        high_s=float(high_s),
        strength=strength,
        p_value=min(tries * 0.5 * math.erfc(math.sqrt(strength)), 1.0),
    )


def _near(followed: _Followed, span_s: tuple[float, float]) -> IntArray:
    """The moments about as likely as the likeliest within, from the first to the last in one piece."""
    inner = _inner(followed, [span_s])
    return _piece(followed, int(np.argmax(np.where(inner, followed.nats, -np.inf))))


def _piece(followed: _Followed, about: int) -> IntArray:
    """The moments about as likely as the one `about`, in one piece with it."""
    breaks = np.flatnonzero(followed.nats <= followed.nats[about] - _WITHIN_NATS)
    low = breaks[breaks < about].max(initial=-1) + 1
    high = breaks[breaks > about].min(initial=followed.nats.size) - 1
    return np.arange(low, high + 1)


def _follow(
    simulator: Simulator, linear: Linear, slot: Slot, at_s: FloatArray, known: _Followed | None
) -> _Followed:
    """`known` with more moments, all other variables fitted anew to first order at each."""
    plant = linear.structure.plant
    vectors = [plant.with_values({slot: float(moment_s)}).vectors() for moment_s in np.maximum(at_s, 0.0)]
    values, active = (np.array(part) for part in zip(*vectors, strict=True))
    rest = linear.innovations - linear.whitened(simulator.run(values, active, linear.jobs))
    others = [number for number, variable in enumerate(linear.variables) if slot not in variable.slots]
    slopes = linear.slopes[others]
    along = rest @ slopes.T
    normal = slopes @ slopes.T + np.diag(linear.tightness[others]) + 1e-9 * np.eye(len(others))
    taken = np.sum(along * np.linalg.solve(normal, along.T).T, axis=1)
    nats = 0.5 * (taken - np.sum(rest**2, axis=1))
    if known is not None:
        at_s, nats = np.append(known.at_s, at_s), np.append(known.nats, nats)
    at_s, first = np.unique(np.maximum(at_s, 0.0), return_index=True)
    return _Followed(at_s, nats[first])
