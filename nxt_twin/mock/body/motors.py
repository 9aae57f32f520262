"""The three motors: bridges, plants and encoders."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final, Protocol, final

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.physics.modes import MODE_BRAKE, MODE_COAST, MODE_DRIVE, MODE_FLOAT

_PULSE_STEPS: Final = 125
"""The pulse width counter's top: a speed of 100 is on all the time, and more than that no more."""
_COUNTS_PER_RAD: Final = 180.0 / math.pi


class Plants(Protocol):
    """Plants that advance together; `nxt_twin.physics.stepper.Stepper` is one."""

    @property
    def angle(self) -> FloatArray:
        """Angles, rad."""
        ...

    @property
    def shown(self) -> FloatArray:
        """Angles as the encoders show them, rad."""
        ...

    @property
    def current(self) -> FloatArray:
        """Winding currents, A."""
        ...

    def step(self, duty: FloatArray, mode: IntArray, supply_v: float, step_s: float) -> None:
        """Advance with these duties (-1 to 1) and drive modes."""
        ...


@final
class MotorBank:
    """Three motors behind their bridges.

    Args:
        plants: the three plants.

    Attributes:
        watchers: called after a bridge has been set to something else.
    """

    def __init__(self, plants: Plants) -> None:
        self._plants = plants
        count = len(plants.angle)
        self._duty = np.zeros(count)
        self._mode = np.full(count, MODE_COAST, dtype=np.int64)
        self._set = [(0, False)] * count
        self._connected = np.zeros(count)
        self.watchers: list[Callable[[], None]] = []

    @property
    def duty(self) -> FloatArray:
        """What each bridge is set to, -1 to 1, shape (motors,)."""
        return self._duty

    @property
    def mode(self) -> IntArray:
        """The drive mode of each bridge, shape (motors,)."""
        return self._mode

    @property
    def plants(self) -> Plants:
        """The plants behind the bridges."""
        return self._plants

    def set(self, port: int, speed: int, *, brake: bool) -> None:
        """Set a bridge, as `Hardware.set_motor` says."""
        if self._set[port] == (speed, brake):
            return
        self._set[port] = (speed, brake)
        steps = min(abs(speed) * _PULSE_STEPS // 100, _PULSE_STEPS)
        self._duty[port] = math.copysign(steps / _PULSE_STEPS, speed)
        if steps:
            self._mode[port] = MODE_DRIVE if brake else MODE_FLOAT
        else:
            self._mode[port] = MODE_BRAKE if brake else MODE_COAST
        # A floating winding conducts only while it is connected: its mean current is all that the battery gives.
        floating = self._mode[port] == MODE_FLOAT
        self._connected[port] = np.sign(self._duty[port]) if floating else self._duty[port]
        for watch in self.watchers:
            watch()

    def step(self, supply_v: float, duration_s: float) -> float:
        """Advance, and give the current that the motors draw from the supply, A."""
        self._plants.step(self._duty, self._mode, supply_v, duration_s)
        return float(self._connected.dot(self._plants.current))

    def counts(self) -> list[int]:
        """The encoders' counts since power-on."""
        return [math.floor(angle * _COUNTS_PER_RAD) for angle in self._plants.shown.tolist()]

    def angles_rad(self) -> list[float]:
        """The hubs' true angles, rad."""
        angles: list[float] = self._plants.angle.tolist()
        return angles
