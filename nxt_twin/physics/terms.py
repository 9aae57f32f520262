"""The quantities that a layout's terms use, by name: shared by the assembler and by the plain-Python reference."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from typing import NamedTuple

from nxt_twin.errors import PlantError
from nxt_twin.physics.effect import Effect, Stage, Term
from nxt_twin.physics.layout import Layout
from nxt_twin.physics.stages import STAGES


class Call(NamedTuple):
    """One term in its place: the effect, its position in the active mask, and the arguments by name."""

    effect: Effect
    position: int
    term: Term
    arguments: tuple[str, ...]


def calls(plan: Layout, stage: Stage) -> Iterator[Call]:
    """The terms of all effects at `stage`, in the order in which they act.

    Raises:
        PlantError: a term is a lambda, or asks for something that its stage does not offer.
    """
    for position, effect in enumerate(plan.effects):
        if stage not in effect.terms:
            continue
        term = effect.terms[stage]
        if term.__name__ == "<lambda>":
            raise PlantError(
                f"its {stage} term is a lambda, which a kernel cannot import",
                where=f"effect {effect.id}",
                mend="define a function at the top of a module",
            )
        arguments = tuple(inspect.signature(term).parameters)
        own = {parameter.symbol for parameter in effect.parameters} | set(effect.states)
        offered = own | set(STAGES[stage].reads)
        for name in arguments:
            if name not in offered:
                raise PlantError(
                    f"its {stage} term asks for '{name}'",
                    where=f"effect {effect.id}",
                    mend=f"this stage offers {', '.join(sorted(offered))}",
                )
        yield Call(effect, position, term, arguments)
