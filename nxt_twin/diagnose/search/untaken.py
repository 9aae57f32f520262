"""Ways that a search has seen and not gone: where it ends without an answer, one of them may lead to it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.search.limits import LIMITS
from nxt_twin.diagnose.search.weight import Weight, weigh
from nxt_twin.physics.effect import Effect


@final
class Untaken:
    """The structures with one effect more than another that led on, by likelihood or by simulation."""

    def __init__(self) -> None:
        self._led_on: dict[frozenset[str], Structure] = {}

    def note(self, simpler: Structure, settled: Sequence[tuple[Effect, Structure]]) -> None:
        """Note those of the structures, `settled` with an effect beside `simpler`, that lead on."""
        for _, structure in settled:
            if leads_on(weigh(simpler, structure)):
                self._led_on[structure.plant.active] = structure

    def beside(self, best: Structure) -> tuple[Structure, ...]:
        """Those with an effect that `best` lacks, that which simulates best first."""
        others = [one for active, one in self._led_on.items() if not active <= best.plant.active]
        return tuple(sorted(others, key=lambda one: one.free_run_rms[0]))


def leads_on(weight: Weight) -> bool:
    """Whether an effect is likelier than chance, though free runs may deny it, or simulates much nearer.

    Where two things are missing, the noise of a fit with one of them may be less likely than that which takes in both.
    """
    likelier = weight.gain > LIMITS.gain_nats and weight.check_gain > LIMITS.check_nats
    return likelier or weight.free_run_ratio < LIMITS.much_nearer
