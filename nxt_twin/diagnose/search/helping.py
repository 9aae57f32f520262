"""Refused effects that help: those for which much speaks, each in the place that it would have had."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from nxt_twin.diagnose.search.coincidence import are_twins
from nxt_twin.diagnose.search.explain import Explanation, Ranked
from nxt_twin.diagnose.search.rivals import Rival, simulates_worse
from nxt_twin.diagnose.search.settled import simpler
from nxt_twin.physics.plant import Plant

_HELPING_NATS: Final = 10.0
"""What fitted and checking readings together have to gain by an effect that the search refused."""
_FURTHER_NATS: Final = 20.0
"""As `_HELPING_NATS`, beside found effects. On a real servo a power curve gained 15 beside the right name.

On another one friction of the gear gained 24, in windows of simulation alone.
"""
_MOST: Final = 3  # refused effects that are looked at again


def helping(explanation: Explanation, given: Plant) -> list[Explanation]:
    """`explanation` with each refused effect that helps, beside what was found, the most helpful first.

    `given` is the plant as it came.
    """
    bare = explanation.best.plant.active
    least_nats = _FURTHER_NATS if explanation.found else _HELPING_NATS
    near = [
        one
        for one in explanation.refused
        if _helps(one, least_nats) and simpler(one[2].plant, one[0].id, given).active == bare
    ]
    near.sort(key=lambda one: -one[1].total)
    return [_with(explanation, one, [other for other in near if other is not one]) for one in near[:_MOST]]


def _helps(one: Ranked, least_nats: float) -> bool:
    """Whether much speaks for a refused effect, and readings that were not fitted do not deny it."""
    _, weight, _ = one
    nearer = weight.check_gain > 0.0 or weight.free_run_ratio < 1.0
    return weight.total > least_nats and weight.gain > 0.0 and nearer


def _with(explanation: Explanation, one: Ranked, others: list[Ranked]) -> Explanation:
    """`explanation` with `one` for a found effect, and the `others` for its rivals."""
    effect, weight, structure = one
    rivals = sorted((_rival(one, other) for other in others), key=lambda rival: rival.doubt_nats)
    return replace(
        explanation,
        best=structure,
        found=(*explanation.found, (effect, weight)),
        rivals={**explanation.rivals, effect.id: tuple(rivals)},
    )


def _rival(leader: Ranked, other: Ranked) -> Rival:
    """`other` in the place of `leader`."""
    effect, weight, structure = leader
    rival, less, trial = other
    twins = are_twins(structure.plant, effect, rival) or are_twins(trial.plant, rival, effect)
    worse = simulates_worse(structure, trial, rival)
    return Rival(rival, weight.total - less.total, trial, worse, twins)
