"""Plants that are stepped from outside, tick by tick, as a mock brick does."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.errors import PlantError
from nxt_twin.physics.kernel import Kernel, kernel
from nxt_twin.physics.late import LateCommands
from nxt_twin.physics.plant import Plant

_ANGLE, _SPEED, _CURRENT = 0, 1, 2


@final
class Stepper:
    """Several plants of one kind, at rest at angle zero, that advance together.

    Args:
        plants: of one layout. Faults of the recording in them (stale samples) have no meaning here.
        ready: load the compiled kernel, which takes half a second, at the first step; else once something can move.

    Raises:
        PlantError: the plants are of different kinds, or none is given.
    """

    def __init__(self, plants: Sequence[Plant], *, ready: bool = True) -> None:
        if len({plant.layout for plant in plants}) != 1:
            raise PlantError("a stepper takes one or more plants of one kind", where="plants")
        plan = plants[0].layout
        self._plan = plan
        vectors = [plant.vectors() for plant in plants]
        self._values = np.array([values for values, _ in vectors])
        self._active = np.array([active for _, active in vectors])
        states = sum(len(effect.states) for effect in plan.effects)
        self._state = np.zeros((len(plants), 3 + states))
        self._elapsed_s = 0.0
        self._shows_truth = not any("reading" in effect.terms for plant in plants for effect in plant.effects)
        self._commands = LateCommands(plants)
        # Friction and inductance move nothing that is at rest; other effects may, such as a hanging weight.
        self._may_rest = not ready and all(effect.plain for plant in plants for effect in plant.effects)

    @cached_property
    def _kernel(self) -> Kernel:
        return kernel(self._plan)

    @property
    def angle(self) -> FloatArray:
        """True angles, rad, shape (plants,)."""
        return self._state[:, _ANGLE]

    @property
    def speed(self) -> FloatArray:
        """Speeds, rad/s, shape (plants,)."""
        return self._state[:, _SPEED]

    @property
    def shown(self) -> FloatArray:
        """Angles as the encoders show them, rad, shape (plants,)."""
        if self._shows_truth:
            return self.angle
        shown = np.empty((self._state.shape[0], 2))
        self._kernel.read_many(self._values, self._active, self._state, shown)
        return shown[:, 0]

    @property
    def current(self) -> FloatArray:
        """Winding currents, A, shape (plants,)."""
        return self._state[:, _CURRENT]

    def step(self, duty: FloatArray, mode: IntArray, supply_v: float, step_s: float) -> None:
        """Advance by `step_s` with these duties (-1…1) and drive modes, each of shape (plants,)."""
        in_force, mode_in_force = self._commands.at(self._elapsed_s, duty, mode)
        self._may_rest = self._may_rest and not any(in_force.tolist())
        if not self._may_rest:
            self._kernel.step_many(
                self._values,
                self._active,
                self._state,
                in_force,
                mode_in_force,
                supply_v,
                self._elapsed_s,
                step_s,
            )
        self._elapsed_s += step_s
