"""All effects this installation knows: the built-in ones and those of other packages."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from importlib.metadata import entry_points

from nxt_twin.errors import PlantError
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.effects import BUILT_IN

ENTRY_POINT_GROUP = "nxt_twin.effects"


@cache
def library() -> dict[str, Effect]:
    """Every known effect by id, in the order in which their terms act.

    A package adds effects by an entry point in the group `nxt_twin.effects` that names an `Effect`.

    Raises:
        PlantError: two effects share an id, or an entry point does not name an effect.
    """
    effects = {effect.id: effect for effect in BUILT_IN}
    for point in entry_points(group=ENTRY_POINT_GROUP):
        effect = point.load()
        if not isinstance(effect, Effect):
            raise PlantError("does not name an Effect", where=f"entry point {point.name} = {point.value}")
        if effect.id in effects:
            raise PlantError(f"the effect id {effect.id} is taken", where=f"entry point {point.name}")
        effects[effect.id] = effect
    return {effect.id: _mutual(effect, effects) for effect in effects.values()}


def name_of(effect_id: str) -> str:
    """The name of an effect in words; of one that this installation does not know, its id in words."""
    effect = library().get(effect_id)
    return effect.name if effect else effect_id.replace("_", " ")


def _mutual(effect: Effect, effects: Mapping[str, Effect]) -> Effect:
    """The effect with the confusions that others declare with it."""
    others = {
        other.id: other.confusable_with[effect.id]
        for other in effects.values()
        if effect.id in other.confusable_with
    }
    return replace(effect, confusable_with={**others, **effect.confusable_with})
