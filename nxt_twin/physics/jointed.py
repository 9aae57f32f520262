"""Plants that drive the joints of somebody else's bodies: angle and speed in, torque and friction out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.errors import PlantError
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.kernel import kernel, turning
from nxt_twin.physics.late import LateCommands
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.modes import MODE_COAST
from nxt_twin.physics.plant import Plant

_ANGLE, _CURRENT = 0, 2
_BODIES: Final = ("inertia", "stop")
"""Stages whose terms say how a body moves, which is not the plant's to say here."""


@final
class JointDrives:
    """Several plants of one kind, each on a joint; their inertia is to be part of the joint's body.

    Args:
        plants: of one layout. Faults of the recording in them (stale samples) have no meaning here.

    Attributes:
        exerted: torques of the next step, N·m, shape (plants, 2): first without dry friction, then the most that dry
            friction holds or brakes.
        inertia_kg_m2: the inertia that each adds to its joint's body, about the joint's axis, shape (plants,).

    Raises:
        PlantError: the plants are of different kinds, none is given, or one holds bodies or stops of its own.
    """

    def __init__(self, plants: Sequence[Plant]) -> None:
        if len({plant.layout for plant in plants}) != 1:
            raise PlantError("joints are driven by one or more plants of one kind", where="plants")
        for plant in plants:
            for effect in plant.effects:
                if _is_a_body(effect):
                    mend = "say it of the robot's parts: a mass, a limit"
                    raise PlantError(
                        "is a body or a stop, which a world has itself", where=effect.id, mend=mend
                    )
        plan = plants[0].layout
        self._turn, self._read = turning(plan), kernel(plan).read_many
        vectors = [plant.vectors() for plant in plants]
        self._values = np.array([values for values, _ in vectors])
        self._active = np.array([active for _, active in vectors])
        self._state = np.zeros((len(plants), 3 + sum(len(effect.states) for effect in plan.effects)))
        self._shows_truth = not any("reading" in e.terms for plant in plants for e in plant.effects)
        self._late = LateCommands(plants)
        self._duty = np.zeros((2, len(plants)))
        self._mode = np.full((2, len(plants)), MODE_COAST, dtype=np.int64)
        self._supply_v, self._elapsed_s = np.zeros(2), np.zeros(2)
        self._angle = np.zeros(len(plants))
        self.exerted = np.zeros((len(plants), 2))
        self.inertia_kg_m2 = np.array([plant.values[Slot(BASE_OWNER, "inertia")] for plant in plants])

    @property
    def angle(self) -> FloatArray:
        """The joints' angles as they were last given, rad, shape (plants,)."""
        return self._angle

    @property
    def shown(self) -> FloatArray:
        """Those angles as the encoders show them, rad, shape (plants,)."""
        if self._shows_truth:
            return self._angle
        state, shown = self._state.copy(), np.empty((self._state.shape[0], 2))
        state[:, _ANGLE] = self._angle
        self._read(self._values, self._active, state, shown)
        return shown[:, 0]

    @property
    def current(self) -> FloatArray:
        """Winding currents, A, shape (plants,)."""
        return self._state[:, _CURRENT]

    def turn(
        self, joint: FloatArray, duty: FloatArray, mode: IntArray, supply_v: float, step_s: float
    ) -> None:
        """Form what acts in the next step (`exerted`).

        Args:
            joint: angle (rad) and speed (rad/s) of each joint now, shape (plants, 2).
            duty: of each bridge for the step, -1 to 1, shape (plants,).
            mode: of each bridge, shape (plants,).
            supply_v: what feeds them.
            step_s: length of the step that has ended and of the one to come.
        """
        self._duty[0], self._mode[0] = self._duty[1], self._mode[1]
        self._supply_v[0], self._elapsed_s[0] = self._supply_v[1], self._elapsed_s[1]
        self._elapsed_s[1] += step_s
        self._duty[1], self._mode[1] = self._late.at(float(self._elapsed_s[1]), duty, mode)
        self._supply_v[1] = supply_v
        self._turn(
            self._values,
            self._active,
            self._state,
            self._duty,
            self._mode,
            self._supply_v,
            self._elapsed_s,
            step_s,
            joint,
            self.exerted,
        )

    def follow(self, joint: FloatArray) -> None:
        """Take the joints' angles after the step, for the encoders; all else is settled by the next `turn`."""
        self._angle[:] = joint[:, 0]


def _is_a_body(effect: Effect) -> bool:
    return bool(effect.moving) or any(stage in effect.terms for stage in _BODIES)
