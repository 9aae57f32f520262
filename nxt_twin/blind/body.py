"""A mock brick's motor that follows the independent simulator, with whatever is concealed in it."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final, cast, final

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.blind.secret import Secret
from nxt_twin.blind.truth import integrator
from nxt_twin.blind.truth.motor import Motor, as_record
from nxt_twin.blind.truth.sensing import Sensing
from nxt_twin.mock.body.battery import Battery
from nxt_twin.mock.body.body import Body
from nxt_twin.mock.body.motors import MotorBank, Plants
from nxt_twin.recording.columns import PORTS

_ROUNDING_S: Final = 1e-9


@final
class TrueMotor:
    """One motor, stepped from outside; at rest at angle zero.

    Args:
        motor: its numbers; the battery's are taken from what feeds it.
        sensing: the delay of its commands, and its encoder's eccentricity.
    """

    def __init__(self, motor: Motor, sensing: Sensing) -> None:
        fed = replace(motor, internal_resistance_ohm=0.0, drain_v_per_s=0.0)
        self._record = as_record(fed)
        self._exponent = motor.power_exponent
        self._sensing = sensing
        self._state = np.zeros(integrator.STATES)
        self._states = np.zeros((2, integrator.STATES))
        self._time_s, self._duty = np.zeros(2), np.zeros(2)
        self._mode, self._nothing = np.zeros(2, dtype=np.int64), np.zeros(2)
        self._terminal_v = np.zeros(2)
        self._waiting: deque[tuple[float, float, int]] = deque()

    @property
    def elapsed_s(self) -> float:
        """Time since it was made, s."""
        return float(self._time_s[1])

    @property
    def shown_rad(self) -> float:
        """The angle that the encoder shows, rad."""
        degrees = np.rad2deg(self._state[[integrator.THETA, integrator.MISCOUNT]])
        return math.radians(float(self._sensing.encoder_deg(degrees[:1], degrees[1:])[0]))

    @property
    def current_a(self) -> float:
        """The winding's current, A."""
        return float(self._state[integrator.CURRENT])

    def step(self, duty: float, mode: int, supply_v: float, step_s: float) -> None:
        """Advance with a duty -1…1 in a drive mode, fed by `supply_v`."""
        self._take(math.copysign(abs(duty) ** self._exponent, duty), mode)
        cast("Any", self._record)["battery_v"] = supply_v
        self._time_s[0] = self._time_s[1]
        self._time_s[1] += step_s
        integrator.integrate(
            self._record,
            self._state,
            self._time_s,
            self._duty,
            self._mode,
            self._nothing,
            self._states,
            self._terminal_v,
        )
        self._state[:] = self._states[1]

    def _take(self, duty: float, mode: int) -> None:
        """Bring into force what was commanded the delay ago."""
        now_s = self.elapsed_s
        self._waiting.append((now_s + self._sensing.delay_s, duty, mode))
        while self._waiting and self._waiting[0][0] <= now_s + _ROUNDING_S:
            _, self._duty[:], self._mode[:] = self._waiting.popleft()


@final
class PlantsWithSecret:
    """The plants of a mock brick, one of which is the true motor; the mock's `Plants`.

    Args:
        plain: the plants as they were.
        index: which of them is replaced.
        secret: by what.
        battery: feeds them; it drains in time where the secret says so.
    """

    def __init__(self, plain: Plants, index: int, secret: Secret, battery: Battery) -> None:
        self._plain = plain
        self._index = index
        self._own = TrueMotor(secret.motor, secret.sensing)
        self._drain_v_per_s = secret.motor.drain_v_per_s
        self._battery = battery

    @property
    def angle(self) -> FloatArray:
        """Angles, rad, of the true motor as its encoder shows it."""
        return self._with(self._plain.angle, self._own.shown_rad)

    @property
    def shown(self) -> FloatArray:
        """Angles as the encoders show them, rad."""
        return self._with(self._plain.shown, self._own.shown_rad)

    @property
    def current(self) -> FloatArray:
        """Winding currents, A."""
        return self._with(self._plain.current, self._own.current_a)

    def step(self, duty: FloatArray, mode: IntArray, supply_v: float, step_s: float) -> None:
        """Advance with these duties (-1 to 1) and drive modes."""
        self._plain.step(duty, mode, supply_v, step_s)
        self._own.step(float(duty[self._index]), int(mode[self._index]), supply_v, step_s)
        drained_v = self._drain_v_per_s * step_s
        self._battery.open_circuit_v = max(0.0, self._battery.open_circuit_v - drained_v)

    def _with(self, plain: FloatArray, own: float) -> FloatArray:
        values = plain.copy()
        values[self._index] = own
        return values


def hiding(secret: Secret) -> Callable[[Body], None]:
    """What puts the secret into a brick's body, to be passed to whatever switches the brick on."""

    def hide(body: Body) -> None:
        body.battery.resistance_ohm += secret.motor.internal_resistance_ohm
        index = PORTS.index(secret.port)
        body.motors = MotorBank(PlantsWithSecret(body.motors.plants, index, secret, body.battery))

    return hide
