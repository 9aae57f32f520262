"""Heun's method at a fifth of a millisecond for body, wheels and a creeping contact between tyre and floor.

Wheel and body move apart: the tyre's force grows with the creep between its tread and the floor, up to what friction
carries. The diagnosis, which lets wheels roll, shares neither states nor integrator nor friction law.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from nxt_twin.arrays import FloatArray

STEP_S = 2e-4
STATES = 9
"""x, y, heading, speed, turning rate, and of each wheel its rate and its angle."""

_GRAVITY = 9.81
_GRIP = 0.8
_CREEP_M_PER_S = 2e-3
_STICK_RAD_PER_S = 0.04
_STILL_M_PER_S = 4e-3
_ROUNDS = 4


@njit(cache=True)
def winding_current(volts: float, rate: float, p: FloatArray, k: int) -> float:
    """The current of motor k, whose brushes take a part of the voltage, and pass none below it."""
    across = volts - p[13 + k] * rate
    return float(np.sign(across) * max(abs(across) - p[30 + k], 0.0) / p[11 + k])


@njit(cache=True)
def terminal_v(volts: FloatArray, left_rate: float, right_rate: float, p: FloatArray) -> float:
    """The voltage of a battery that feeds both motors, in rounds: less what the last round's current takes."""
    held = p[33]
    if p[32] == 0.0:
        return float(held)
    for _ in range(_ROUNDS):
        drawn = 0.0
        for k in range(2):
            duty, rate = volts[k] / p[33], left_rate if k == 0 else right_rate
            drawn += duty * winding_current(duty * held, rate, p, k)
        held = p[33] - p[32] * max(drawn, 0.0)
    return float(held)


@njit(cache=True)
def slopes(
    state: FloatArray, p: FloatArray, volts: FloatArray, lost: FloatArray, push: FloatArray
) -> FloatArray:
    """Time derivatives of the states.

    Args:
        state: shape (9,).
        p: a `TrueRobot`, packed.
        volts: at the left and the right motor.
        lost: the share of each wheel's travel that slips.
        push: a random force along and a random torque.
    """
    heading, v, w = state[2], state[3], state[4]
    track = p[2] * (1.0 + p[25] * abs(w))
    tread = np.empty(2)
    out = np.zeros(STATES)
    load = 0.4 * p[3] * _GRAVITY
    sagged = terminal_v(volts, state[5], state[7], p) / p[33]
    for k in range(2):
        side = -0.5 if k == 0 else 0.5
        rate = state[5 + 2 * k]
        creep = (1.0 - lost[k]) * p[k] * rate - (v + side * track * w)
        tread[k] = _GRIP * load * np.tanh(creep / _CREEP_M_PER_S)
        drive = p[13 + k] * winding_current(sagged * volts[k], rate, p, k)
        way = np.tanh(rate / _STICK_RAD_PER_S)
        friction = p[15 + k] * way + p[17 + k] * rate + p[26 + k] * way * way + p[28 + k] * rate * abs(rate)
        out[5 + 2 * k] = (drive - friction - p[k] * (1.0 - lost[k]) * tread[k]) / p[19 + k]
        out[6 + 2 * k] = rate
    fall = p[3] * _GRAVITY * np.sin(p[9])
    down_x, down_y = -fall * np.cos(p[10] - heading), -fall * np.sin(p[10] - heading)
    cast = np.hypot(v, p[7] * w)
    held = p[8] * np.tanh(cast / _STILL_M_PER_S) / max(cast, 1e-9)
    along = tread[0] + tread[1] + down_x - held * v + push[0]
    about = (
        0.5 * track * (tread[1] - tread[0]) + p[5] * down_y - p[6] * down_x - held * p[7] * p[7] * w + push[1]
    )
    if state[0] > p[22]:
        along -= p[21] * np.tanh(v / _STILL_M_PER_S)
    along -= p[23] * (state[0] * np.cos(heading) + state[1] * np.sin(heading))
    along += p[3] * w * w * p[5]
    about -= p[3] * p[5] * v * w
    inner = p[4] + p[3] * (p[5] * p[5] + p[6] * p[6])
    mixed = -p[3] * p[6]
    whole = p[3] * inner - mixed * mixed
    out[3] = (inner * along - mixed * about) / whole
    out[4] = (p[3] * about - mixed * along) / whole
    out[0] = v * np.cos(heading) + p[24] * abs(v) * 0.6
    out[1] = v * np.sin(heading) + p[24] * abs(v) * 0.8
    out[2] = w
    return out


@njit(cache=True)
def drive_robot(
    p: FloatArray, until_s: FloatArray, volts: FloatArray, lost: FloatArray, push: FloatArray
) -> FloatArray:
    """States at every stamp.

    Args:
        p: a `TrueRobot`, packed.
        until_s: stamps from 0 on, shape (rows,).
        volts: in force from each stamp to the next, shape (rows, 2).
        lost: likewise the share of travel that slips, shape (rows, 2).
        push: likewise random force and torque, shape (rows, 2).

    Returns:
        Shape (rows, 9).
    """
    state = np.zeros(STATES)
    found = np.zeros((until_s.size, STATES))
    for row in range(1, until_s.size):
        span = until_s[row] - until_s[row - 1]
        steps = max(1, int(np.ceil(span / STEP_S)))
        h = span / steps
        for _ in range(steps):
            first = slopes(state, p, volts[row - 1], lost[row - 1], push[row - 1])
            second = slopes(state + h * first, p, volts[row - 1], lost[row - 1], push[row - 1])
            state = state + 0.5 * h * (first + second)
        found[row] = state
    return found
