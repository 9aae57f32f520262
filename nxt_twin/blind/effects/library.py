"""All effects that a case can hide, by id."""

from __future__ import annotations

from typing import Final

from nxt_twin.blind.effects.chain import CHAIN
from nxt_twin.blind.effects.concealed import ConcealedEffect
from nxt_twin.blind.effects.electrical import ELECTRICAL
from nxt_twin.blind.effects.friction import FRICTION
from nxt_twin.blind.effects.load import LOAD
from nxt_twin.blind.effects.unknown import UNKNOWN

KNOWN_EFFECTS: Final[dict[str, ConcealedEffect]] = {
    effect.id: effect for effect in (*FRICTION, *ELECTRICAL, *CHAIN, *LOAD)
}
"""Those of docs/effects.md, in the order of drawing: the end stop last, since it looks at the rest."""

UNKNOWN_EFFECTS: Final[dict[str, ConcealedEffect]] = {effect.id: effect for effect in UNKNOWN}

EFFECTS: Final[dict[str, ConcealedEffect]] = {**KNOWN_EFFECTS, **UNKNOWN_EFFECTS}


def compatible(ids: tuple[str, ...]) -> bool:
    """Whether these effects can stand in one case."""
    return len(set(ids)) == len(ids) and not any(
        other in EFFECTS[first].clashes for first in ids for other in ids
    )
