"""Who bears the friction, motor or load: a share that a fit hardly moves, so that it is settled from several."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.search.limits import EFFORT
from nxt_twin.diagnose.search.settled import Settled
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot

UNDER_ITS_OWN: Final = (0.0, 0.5)
"""Shares from which a structure is settled again under its own noise."""

UNDER_MORE: Final = 0.25
"""And the one under the noise of what lacks the effect, whose likelihood is less rugged."""

EVENLY: Final = 0.5
"""The share beside less friction."""

LESS_FRICTION: Final = 0.4
"""The dry friction of that start, over that of what lacks the effect."""

HARDLY_ANY: Final = 0.02
"""The unknown torque under which it is settled, over that of what lacks the effect."""

_DRY: Final = Slot("coulomb_friction", "coulomb")
_NO_NEWS_NATS: Final = 5.0
"""A gain below which no further round is made: it is small beside the steps of the likelihood."""


def shared_anew(settled: Settled, best: Structure, trial: Structure, effect: Effect) -> Structure:
    """The best of `trial` and of what settles from other shares of the friction behind `effect`, round after round.

    A load strikes the flank of its play now or a moment later. The likelihood has a step there for each reversal, by
    hundreds of nats in all, and a fit ends a step from where it began. Where no share is likelier, less friction is
    tried.

    Args:
        settled: keeps what was settled.
        best: the structure that lacks the effect.
        trial: the one with it.
        effect: what may have such a share.
    """
    for _ in range(EFFORT.shares if any(each.shared_out for each in effect.parameters) else 0):
        before, trial = trial, _from_other_shares(settled, best, trial, effect)
        if _is_no_news(before, trial):
            before, trial = trial, _from_less_friction(settled, best, trial, effect)
            if _is_no_news(before, trial):
                break
    return trial


def _is_no_news(before: Structure, after: Structure) -> bool:
    return after.fitted_cost > before.fitted_cost - _NO_NEWS_NATS


def _from_less_friction(settled: Settled, best: Structure, trial: Structure, effect: Effect) -> Structure:
    """The better of `trial` and of what settles from a motor that rubs less, under hardly any unknown torque.

    What lacks the play takes the energy that strikes cost for friction, and a fit hardly gives that back.
    """
    shares = {Slot(effect.id, each.symbol): EVENLY for each in effect.parameters if each.shared_out}
    slack = trial.plant.with_values({**shares, **_less_friction(best)})
    sober = replace(best.noise, disturbance_std=HARDLY_ANY * best.noise.disturbance_std)
    return min(trial, settled.settle(slack, sober), key=lambda one: one.fitted_cost)


def _less_friction(best: Structure) -> dict[Slot, float]:
    return {slot: LESS_FRICTION * best.plant.values[slot] for slot in [_DRY] if slot in best.plant.values}


def _from_other_shares(settled: Settled, best: Structure, trial: Structure, effect: Effect) -> Structure:
    slots = [Slot(effect.id, each.symbol) for each in effect.parameters if each.shared_out]
    starts = [(slot, share, trial.noise) for slot in slots for share in UNDER_ITS_OWN]
    starts += [(slot, UNDER_MORE, best.noise) for slot in slots]
    ends = settled.settle_each(
        [(trial.plant.with_values({slot: share}), noise) for slot, share, noise in starts]
    )
    return min([trial, *ends], key=lambda one: one.fitted_cost)
