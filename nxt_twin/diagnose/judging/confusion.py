"""Which other effects would have left the same trace in these very recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.fitting.linear import Linear, deviations, trials_of, with_trial
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.parameter import Scale
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Simulator

_RIDGE = 1e-6  # of a trace's squared length: keeps the solution finite where two starts leave one trace


@final
@dataclass(frozen=True)
class Alike:
    """How near another effect comes to a found one.

    Attributes:
        effect: the other.
        apart_nats: what its best likeness still lacks, by linear theory.
        cosine: of the angle between the two traces, once what a re-fit takes up is taken out of both.
    """

    effect: Effect
    apart_nats: float
    cosine: float


def trace_of(simulator: Simulator, linear: Linear, bare: Plant) -> FloatArray:
    """Change that the effects which `bare` lacks make to the readings of `linear`'s structure, shape (readings,)."""
    trace: FloatArray = -deviations(simulator, linear, [bare])[0]
    return trace


def alike(
    simulator: Simulator, scale: Scale, linear: Linear, effect: Effect, bare: Plant, others: Sequence[Effect]
) -> tuple[Alike, ...]:
    """How alike the traces of `others` are to that of `effect`, the nearest first.

    Args:
        simulator: runs the plants.
        scale: of the plant, for the sizes at which the others are tried.
        linear: the structure that holds `effect`.
        effect: the found one.
        bare: the structure's plant without it.
        others: what could take its place.
    """
    others = [other for other in others if "outlier" not in other.terms]
    trials = [trial for other in others for trial in trials_of(other, scale)]
    if not trials or "outlier" in effect.terms:
        return ()
    moved = deviations(simulator, linear, [bare, *(with_trial(bare, trial) for trial in trials)])
    kept = np.array([all(slot.owner != effect.id for slot in v.slots) for v in linear.variables])
    own: FloatArray = _project(linear, kept, -moved[:1])[0]
    traces = _project(linear, kept, moved[1:] - moved[:1])
    total = max(float(own @ own), 1e-12)
    found = []
    for other in others:
        span = traces[[n for n, trial in enumerate(trials) if trial.effect is other]]
        span = span / np.maximum(np.linalg.norm(span, axis=1, keepdims=True), 1e-12)
        weights = np.linalg.solve(span @ span.T + _RIDGE * np.eye(len(span)), span @ own)
        apart = own - weights @ span
        lacking = min(float(apart @ apart) / total, 1.0)
        found.append(Alike(other, 0.5 * lacking * total, float(np.sqrt(1.0 - lacking))))
    return tuple(sorted(found, key=lambda one: one.apart_nats))


def _project(linear: Linear, kept: BoolArray, vectors: FloatArray) -> FloatArray:
    """What a re-fit of the kept variables leaves, with what their priors hold against it as further entries."""
    priors = np.diag(np.sqrt(linear.tightness[kept]))
    slopes = np.hstack([linear.slopes[kept], priors])
    wanted = np.hstack([vectors, np.zeros((len(vectors), len(priors)))])
    normal = slopes @ slopes.T + 1e-9 * np.eye(len(priors))
    return np.asarray(wanted - np.linalg.solve(normal, slopes @ wanted.T).T @ slopes)


def without(plant: Plant, effect_id: str, baseline: Plant) -> Plant:
    """`plant` without the effect; the plain terms that it had replaced come back at their mean value."""
    effect = plant.layout.effect(effect_id)
    bare = plant.without([effect_id])
    values = [plant.values[Slot(effect_id, p.symbol)] for p in effect.parameters]
    for plain in effect.supersedes:
        symbol = plant.layout.effect(plain).parameters[0].symbol
        if Slot(plain, symbol) in baseline.values:
            bare = bare.with_effect(plain, {symbol: float(np.mean(values))})
    return bare
