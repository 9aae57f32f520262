"""The same motor given to SciPy's LSODA: as a reference of known accuracy, and as a user would write it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals

State = FloatArray  # angle (rad), speed (rad/s), winding current (A)


class Motor(NamedTuple):
    """Equations 1 to 4 and 7 of Gonçalves et al., all SI."""

    resistance: float
    inductance: float
    constant: float
    coulomb: float
    viscous: float
    inertia: float

    def slips(self, _: float, state: State, voltage: float, direction: float) -> tuple[float, float, float]:
        """Rates while it turns in `direction`."""
        _, speed, current = state
        torque = self.constant * current - self.viscous * speed - direction * self.coulomb
        induced = self.constant * speed
        return speed, torque / self.inertia, (voltage - induced - self.resistance * current) / self.inductance

    def sticks(self, _: float, state: State, voltage: float, __: float) -> tuple[float, float, float]:
        """Rates while friction holds it."""
        return 0.0, 0.0, (voltage - self.resistance * state[2]) / self.inductance

    def turns(self, time_s: float, state: State, voltage: float) -> tuple[float, float, float]:
        """Rates whichever way it turns: friction as the sign of the speed, without a state of rest."""
        return self.slips(time_s, state, voltage, math.copysign(1.0, state[1]))


def motor_of(plant: Plant) -> Motor:
    """The numbers of `plant` for these equations."""
    by_symbol = {slot.symbol: value for slot, value in plant.values.items()}
    return Motor(
        resistance=by_symbol["resistance"],
        inductance=by_symbol["winding"],
        constant=by_symbol["torque_constant"],
        coulomb=by_symbol["coulomb"],
        viscous=by_symbol["viscous"],
        inertia=by_symbol["inertia"],
    )


def as_a_user(motor: Motor, signals: Signals, rtol: float) -> FloatArray:
    """Angles at the readings, rad: one call of `solve_ivp` for each command, `rtol` also as `atol`."""
    angle = np.zeros(signals.time_s.size)
    state = np.zeros(3)
    for span, voltage, rows in _commands(signals):
        due = np.clip(signals.time_s[rows], *span)
        found = solve_ivp(
            motor.turns, span, state, method="LSODA", t_eval=due, args=(voltage,), rtol=rtol, atol=rtol
        )
        angle[rows] = found.y[0]
        state = found.y[:, -1]
    return angle


def reference(motor: Motor, signals: Signals, rtol: float = 1e-10) -> FloatArray:
    """Angles at the readings, rad, with every stop and every breakaway met exactly as an event."""
    angle = np.zeros(signals.time_s.size)
    state, direction = np.zeros(3), 0.0
    for (now, end), voltage, rows in _commands(signals):
        while now < end:
            found = _until_event(motor, (now, end), state, voltage, direction, rtol)
            reached = rows[(signals.time_s[rows] > now) & (signals.time_s[rows] <= found.t[-1] + 1e-9)]
            if reached.size:
                angle[reached] = found.sol(np.minimum(signals.time_s[reached], found.t[-1]))[0]
            now, state = found.t[-1], found.y[:, -1].copy()
            if found.status == 1:  # it came to rest, or broke away
                held = direction != 0.0 and motor.constant * abs(state[2]) <= motor.coulomb
                direction = 0.0 if held else math.copysign(1.0, state[2])
                state[1] = 0.0
    return angle


def _until_event(
    motor: Motor, span: tuple[float, float], state: State, voltage: float, direction: float, rtol: float
) -> Any:  # noqa: ANN401  # SciPy's result
    def stops(_: float, state: State, __: float, direction: float) -> float:
        return direction * float(state[1])

    def breaks_away(_: float, state: State, __: float, ___: float) -> float:
        return motor.constant * abs(float(state[2])) - motor.coulomb

    moving = direction != 0.0
    event: Any = stops if moving else breaks_away
    event.terminal, event.direction = True, -1 if moving else 1
    return solve_ivp(
        motor.slips if moving else motor.sticks,
        span,
        state,
        method="LSODA",
        args=(voltage, direction),
        events=event,
        dense_output=True,
        rtol=rtol,
        atol=1e-2 * rtol,
    )


def _commands(signals: Signals) -> Iterator[tuple[tuple[float, float], float, Any]]:
    """Each command's span, s, its voltage, and the rows of the readings due in it."""
    ends = [*signals.command_time_s[1:], signals.time_s[-1]]
    voltage = signals.command * signals.command_supply_v
    for start, end, volts in zip(signals.command_time_s, ends, voltage, strict=True):
        inside = (signals.time_s > start + 1e-9) & (signals.time_s <= end + 1e-9)
        yield (float(start), float(end)), float(volts), np.flatnonzero(inside)
