"""Where each parameter stands in the vector that a kernel takes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from typing import NamedTuple, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import PlantError
from nxt_twin.physics.base.base import Base
from nxt_twin.physics.base.dc_motor import DC_MOTOR
from nxt_twin.physics.base.rigid_body import RIGID_BODY
from nxt_twin.physics.base.servo import SERVO
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.library import library
from nxt_twin.physics.parameter import Frame, Parameter

BASES: dict[str, Base] = {base.kind: base for base in (DC_MOTOR, RIGID_BODY, SERVO)}

BASE_OWNER = "base"
DRIVEN_BY = (
    "take another plant, or write another `input: {kind: …}` in the mapping. A dc_motor takes power_pct, voltage_v or "
    "current_a; a servo a goal; a rigid_body torque_nm or force_n"
)


class Slot(NamedTuple):
    """A parameter's address: its owner (`base` or an effect's id) and its symbol."""

    owner: str
    symbol: str


@final
@dataclass(frozen=True, eq=False)
class Layout:
    """The parameters and effects of one kind of plant, in the order of a kernel's vectors."""

    base: Base
    frame: Frame

    @cached_property
    def effects(self) -> tuple[Effect, ...]:
        """The effects that this frame can have, in the order of the `active` mask."""
        return tuple(
            effect
            for effect in library().values()
            if self.frame in effect.frames and (not effect.kinds or self.base.kind in effect.kinds)
        )

    @cached_property
    def parameters(self) -> dict[Slot, Parameter]:
        """All parameters under their names in this frame, in the order of the value vector."""
        owned = [(BASE_OWNER, self.base.parameters), *((e.id, e.parameters) for e in self.effects)]
        return {Slot(owner, p.symbol): p.in_frame(self.frame) for owner, ps in owned for p in ps}

    @cached_property
    def tied(self) -> dict[Slot, list[Slot]]:
        """The parameters that go along with each of those that others are tied to, in the order of the value vector."""
        found: dict[Slot, list[Slot]] = {}
        for slot, parameter in self.parameters.items():
            if parameter.tied_to:
                found.setdefault(Slot(slot.owner, parameter.tied_to), []).append(slot)
        return found

    @cached_property
    def index(self) -> dict[Slot, int]:
        """Position of each parameter in the value vector."""
        return {slot: i for i, slot in enumerate(self.parameters)}

    @cached_property
    def first_starts(self) -> FloatArray:
        """Each parameter's first start, SI, in the order of the value vector."""
        return np.array([parameter.starts[0] * parameter.si for parameter in self.parameters.values()])

    def effect(self, effect_id: str) -> Effect:
        """The effect of that id.

        Raises:
            PlantError: this kind of plant cannot have it, or nobody knows it.
        """
        for effect in self.effects:
            if effect.id == effect_id:
                return effect
        known = ", ".join(e.id for e in self.effects)
        raise PlantError(
            f"a {self.frame} plant has no effect '{effect_id}'", where="effects", mend=f"known are {known}"
        )


@cache
def layout(kind: str, frame: Frame) -> Layout:
    """The layout of plants of `kind` in `frame`.

    Raises:
        PlantError: there is no such kind of plant.
    """
    if kind not in BASES:
        raise PlantError(
            f"unknown kind of plant '{kind}'", where="plant", mend=f"use one of {', '.join(BASES)}"
        )
    base = BASES[kind]
    if frame not in base.frames:
        raise PlantError(
            f"a {kind} cannot be a {frame} plant",
            where="plant",
            mend=DRIVEN_BY,
        )
    return Layout(base, frame)
