"""The brick's motors in a world: those on the robot drive its joints, the others turn freely."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.physics.jointed import JointDrives
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.stepper import Stepper
from nxt_twin.world.engine import Engine


@final
class WorldPlants:
    """Three motors whose step is the world's; the mock's `Plants`.

    Args:
        plants: on ports A, B and C.
        engine: the world, its driven joints in the order of `driven`.
        driven: which of the three are on the robot.
        after: called when a step has passed.
    """

    def __init__(
        self, plants: Sequence[Plant], engine: Engine, driven: Sequence[int], after: Callable[[], None]
    ) -> None:
        self._engine = engine
        self._after = after
        self._driven, self._free = _slices(driven, len(plants))
        free = plants[self._free]
        self._drives = JointDrives(plants[self._driven])
        self._stepper = Stepper(free, ready=False) if free else None
        self._joint = np.zeros((len(driven), 2))
        self._angle, self._shown, self._current = (np.zeros(len(plants)) for _ in range(3))

    def drives_joint(self, index: int) -> bool:
        """Whether the motor of that index (0 to 2) is on the robot."""
        return index in range(*self._driven.indices(len(self._angle)))

    @property
    def angle(self) -> FloatArray:
        """Angles, rad, shape (3,)."""
        return self._angle

    @property
    def shown(self) -> FloatArray:
        """Angles as the encoders show them, rad, shape (3,)."""
        return self._shown

    @property
    def current(self) -> FloatArray:
        """Winding currents, A, shape (3,)."""
        return self._current

    def step(self, duty: FloatArray, mode: IntArray, supply_v: float, step_s: float) -> None:
        """Let the world advance with these duties and drive modes. A step of the brick is one of the engine's."""
        drives, driven = self._drives, self._driven
        drives.turn(self._joint, duty[driven], mode[driven], supply_v, step_s)
        self._engine.exert(drives.exerted)
        self._engine.step()
        self._engine.joints(self._joint)
        drives.follow(self._joint)
        self._angle[driven], self._shown[driven] = drives.angle, drives.shown
        self._current[driven] = drives.current
        if self._stepper is not None:
            self._stepper.step(duty[self._free], mode[self._free], supply_v, step_s)
            self._angle[self._free], self._shown[self._free] = self._stepper.angle, self._stepper.shown
            self._current[self._free] = self._stepper.current
        self._after()


def _slices(driven: Sequence[int], count: int) -> tuple[slice, slice]:
    """Some of up to three motors, in order, and the others."""
    free = [index for index in range(count) if index not in driven]
    return _slice(driven), _slice(free)


def _slice(indices: Sequence[int]) -> slice:
    if not indices:
        return slice(0, 0)
    return slice(indices[0], indices[-1] + 1, max(1, (indices[-1] - indices[0]) // max(1, len(indices) - 1)))
