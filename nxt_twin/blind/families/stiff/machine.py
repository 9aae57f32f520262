"""The machine of this family, and the physics in nobody's library that it knows."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, final

import numpy as np
from scipy.integrate import solve_ivp

from nxt_twin.arrays import FloatArray
from nxt_twin.blind.families.compiled import as_record
from nxt_twin.blind.families.machine import Machine
from nxt_twin.blind.families.numbers import Numbers
from nxt_twin.blind.families.setting import DrawnCase, HiddenEffect, Hideable
from nxt_twin.blind.families.stiff import rates as own

RELATIVE: Final = 1e-4
ABSOLUTE: Final = np.array([1e-4, 3e-3, 5e-4, 5e-6, 5e-6, 1e-4, 3e-3, 1e-5, 1e-4, 1e-4])
RESTITUTION: Final = 0.3
SLOWEST_BOUNCE_RAD_S: Final = 0.15
APART_S: Final = 1e-9


@final
class Stiff(Machine):
    """A motor at rest at `start_rad`; its load stands in the middle of its play."""

    def __init__(self, motor: Numbers, start_rad: float, begins_s: float = 0.0) -> None:
        self._motor, self._numbers = motor, as_record(motor)
        self._x = np.zeros(own.STATES)
        self._x[[own.THETA, own.THETA_L]] = start_rad
        self._now_s = begins_s
        self._held = False

    def run(self, stops_s: FloatArray, duty: float, mode: int) -> FloatArray:
        """As `Machine.run`."""
        out = np.zeros((stops_s.size, own.STATES))
        end_s = float(stops_s[-1])
        while end_s - self._now_s > APART_S:
            until_s = end_s
            if self._now_s < self._motor.added_from_s < end_s:
                until_s = self._motor.added_from_s
            self._piece(until_s, stops_s, out, duty, mode)
        out[stops_s >= self._now_s - APART_S] = self._x
        volts = [
            own.volts(self._numbers, float(stop), float(x[own.CURRENT]), duty, mode)
            for stop, x in zip(stops_s, out, strict=True)
        ]
        return np.column_stack([out[:, own.THETA], out[:, own.MISCOUNT], volts])

    def _piece(self, until_s: float, stops_s: FloatArray, out: FloatArray, duty: float, mode: int) -> None:
        """Integrate to `until_s` or to the next event, and fill in the stops passed."""
        heavier = self._now_s >= self._motor.added_from_s
        rows = np.flatnonzero((stops_s > self._now_s) & (stops_s <= until_s))
        held, numbers = self._held, self._numbers
        done = solve_ivp(
            lambda t, x: own.rates(numbers, t, x, duty, mode, held, heavier),
            (self._now_s, until_s),
            self._x,
            method="Radau",
            jac=lambda t, x: own.slopes(numbers, t, x, duty, mode, held, heavier),
            rtol=RELATIVE,
            atol=ABSOLUTE,
            dense_output=rows.size > 0,
            events=self._event(),
            first_step=min(5e-4, until_s - self._now_s),
        )
        reached_s = float(done.t[-1])
        passed = rows[stops_s[rows] <= reached_s]
        if passed.size:
            out[passed] = done.sol(stops_s[passed]).T
        self._x = np.array(done.y[:, -1])
        self._now_s = until_s if done.status == 0 else reached_s
        if done.status == 1:
            self._hit()

    def _event(self) -> list[Callable[[float, FloatArray], float]]:
        """A stop that is hit, or one that lets go; none where there is no stop."""
        motor = self._motor
        if motor.stop_side == 0.0:
            return []
        scratch = np.zeros(own.STATES)

        def leaves(t: float, x: FloatArray) -> float:
            return float(motor.stop_side * own.push(self._numbers, t, x, scratch))

        def meets(_: float, x: FloatArray) -> float:
            return float(motor.stop_side * (motor.stop_rad - x[own.THETA]))

        event: Any = leaves if self._held else meets
        event.terminal, event.direction = True, -1.0
        return [event]

    def _hit(self) -> None:
        """Turn the speed round, or come to rest against the stop, or leave it."""
        if self._held:
            self._held = False
            self._x[own.THETA] = self._motor.stop_rad - 1e-9 * self._motor.stop_side
            return
        self._x[own.OMEGA] *= -RESTITUTION
        self._x[own.THETA] = self._motor.stop_rad - 1e-9 * self._motor.stop_side
        if abs(self._x[own.OMEGA]) < SLOWEST_BOUNCE_RAD_S:
            self._x[own.OMEGA] = 0.0
            pushed = own.push(self._numbers, self._now_s, self._x, np.zeros(own.STATES))
            self._held = self._motor.stop_side * pushed > 0.0


def _ageing_friction(at: DrawnCase) -> HiddenEffect:
    torque = at.torque(small=(3e-3, 5e-3), medium=(8e-3, 12e-3), large=(18e-3, 28e-3))
    return _strange(own.AGEING_FRICTION, a=torque, b=at.between(0.3, 1.5))


def _eddy_brake(at: DrawnCase) -> HiddenEffect:
    torque = at.torque(small=(0.02, 0.03), medium=(0.05, 0.08), large=(0.12, 0.2))
    fastest = at.motor.supply_v / at.motor.torque_constant_nm_per_a
    return _strange(own.EDDY_BRAKE, a=torque, b=fastest * at.between(0.1, 0.25))


def _tired_magnet(at: DrawnCase) -> HiddenEffect:
    fall = at.among(small=(0.06, 0.09), medium=(0.14, 0.2), large=(0.28, 0.4))
    fastest = at.motor.supply_v / at.motor.torque_constant_nm_per_a
    return _strange(own.TIRED_MAGNET, a=fall, b=at.between(0.4, 2.0), c=0.8 * fastest)


def _crank(at: DrawnCase) -> HiddenEffect:
    share = at.among(small=(0.15, 0.22), medium=(0.35, 0.5), large=(0.65, 0.85))
    return _strange(own.CRANK, a=share, b=at.pick(1.0, 2.0, 3.0), d=at.phase())


def _strange(kind: int, **numbers: float) -> HiddenEffect:
    return HiddenEffect(numbers, {"stranger": float(kind), **numbers})


STRANGERS: Final = (
    Hideable("ageing_friction", "torque_balance", _ageing_friction, known=False),
    Hideable("eddy_brake", "torque_balance", _eddy_brake, known=False),
    Hideable("tired_magnet", "electrical", _tired_magnet, known=False),
    Hideable("crank", "torque_balance", _crank, known=False),
)
"""One in a case."""
