"""Carpets: where the floor holds on more or less than elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, final

from nxt_twin.arrays import FloatArray
from nxt_twin.world.engine import Body, Engine
from nxt_twin.world.scene import Carpet

_EVERY_STEPS: Final = 10


@final
class Carpets:
    """Gives the links that stand on a floor the grip of what they stand on; called after each step.

    Args:
        carpets: the last one that a link is on counts.
        floor_friction: elsewhere.
        engine: the world.
        robot: whose links they are.
        grips: the links' own friction, by name.
    """

    def __init__(
        self,
        carpets: Sequence[Carpet],
        floor_friction: float,
        engine: Engine,
        robot: Body,
        grips: dict[str, float],
    ) -> None:
        self._carpets, self._floor_friction = carpets, floor_friction
        self._engine, self._robot, self._grips = engine, robot, grips
        self._in_force = dict.fromkeys(grips, floor_friction)
        self._steps = 0

    def __call__(self) -> None:
        """Look on what each link stands now and then."""
        self._steps += 1
        if self._steps % _EVERY_STEPS:
            return
        for link, own in self._grips.items():
            friction = self._under(1e3 * self._engine.link_place_m(self._robot, link))
            if friction != self._in_force[link]:
                self._in_force[link] = friction
                # A contact's friction is the product of both sides', and the floor's own is the whole floor's.
                self._engine.grip(self._robot, link, own * friction / (self._floor_friction or 1.0))

    def _under(self, place_mm: FloatArray) -> float:
        friction = self._floor_friction
        for carpet in self._carpets:
            (x0, y0), (x1, y1) = carpet.patch_mm
            if min(x0, x1) <= place_mm[0] <= max(x0, x1) and min(y0, y1) <= place_mm[1] <= max(y0, y1):
                friction = carpet.friction
        return friction
