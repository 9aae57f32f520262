"""One true run: commands in, true angle and raw readings out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.blind.truth import integrator, surprises
from nxt_twin.blind.truth.motor import Motor, as_record
from nxt_twin.blind.truth.sensing import Sensing

BATTERY_REFRESH_S = 0.167
SPIN_UP_S = 0.5


@final
@dataclass(frozen=True)
class Commands:
    """The host's polls and commands. Arrays have shape (rows,).

    Attributes:
        read_s: true time of each reading, and of each command.
        power_pct: duty commanded, -100…100, whole numbers.
        mode: 0 drive, 1 float, 2 coast, 3 brake.
        start_deg: hub angle at the first reading.
        before_pct: duty held for a while before the first reading; 0 starts at rest.
        push_nm: an unmodelled torque from each reading to the next.
    """

    read_s: FloatArray
    power_pct: FloatArray
    mode: IntArray
    start_deg: float
    before_pct: float
    push_nm: FloatArray


@final
@dataclass(frozen=True)
class TrueRun:
    """What came of the commands; arrays have shape (rows,).

    Attributes:
        stamp_s: the host's stamps.
        hub_deg: true angle of the hub at the true time of each reading.
        encoder_deg: what the encoder says there, before it is cut to whole degrees.
        terminal_v: the battery's terminal voltage as the brick last refreshed it.
    """

    stamp_s: FloatArray
    hub_deg: FloatArray
    encoder_deg: FloatArray
    terminal_v: FloatArray


def true_run(motor: Motor, sensing: Sensing, commands: Commands) -> TrueRun:
    """Simulate one recording without its quantisation and noise."""
    read_s = commands.read_s
    issued_s = read_s + sensing.lag_s(read_s)
    act_s = issued_s + sensing.delay_s
    refresh_s = np.arange(read_s[0], read_s[-1], BATTERY_REFRESH_S)
    event_s = np.unique(np.concatenate([read_s, act_s, refresh_s]))
    in_force = np.searchsorted(act_s, event_s, side="right") - 1
    duty = np.where(in_force < 0, commands.before_pct / 100.0, _duty(motor, commands)[in_force])
    mode = np.where(in_force < 0, 0, commands.mode[in_force])
    push = commands.push_nm[np.clip(np.searchsorted(read_s, event_s, side="right") - 1, 0, None)]

    states = np.zeros((event_s.size, integrator.STATES))
    terminal_v = np.zeros(event_s.size)
    record = as_record(motor)
    start = _start(motor, commands)
    integrator.integrate(record, start, event_s, duty, mode, push, states, terminal_v)

    at_read = np.searchsorted(event_s, read_s)
    last_refresh = refresh_s[np.searchsorted(refresh_s, read_s, side="right") - 1]
    hub_deg = np.rad2deg(states[at_read, integrator.THETA])
    miscount_deg = np.rad2deg(states[at_read, integrator.MISCOUNT])
    return TrueRun(
        stamp_s=np.round((1.0 + sensing.rate_error) * issued_s, 6),
        hub_deg=hub_deg,
        encoder_deg=sensing.encoder_deg(hub_deg, miscount_deg),
        terminal_v=terminal_v[np.searchsorted(event_s, last_refresh)],
    )


def _duty(motor: Motor, commands: Commands) -> FloatArray:
    """The duty that the bridge makes of each command."""
    duty = commands.power_pct / 100.0
    duty = np.sign(duty) * np.abs(duty) ** motor.power_exponent
    if int(motor.surprise) == surprises.AMPLIFIER_MEMORY:
        duty = _with_memory(duty, commands.read_s, motor.surprise_a, motor.surprise_b)
    return np.asarray(duty, dtype=np.float64)


def _with_memory(duty: FloatArray, issued_s: FloatArray, share: float, memory_s: float) -> FloatArray:
    """Saturate at `share` of full duty for `memory_s` after each change of the command's sign."""
    turned = np.sign(duty) * np.sign(np.concatenate([[0.0], duty[:-1]])) < 0.0
    last_turn_s = np.maximum.accumulate(np.where(turned, issued_s, -np.inf))
    return np.where(issued_s - last_turn_s < memory_s, share * np.tanh(duty / share), duty)


def _start(motor: Motor, commands: Commands) -> FloatArray:
    """The state at the first reading: at rest, or after half a second of `before_pct`."""
    start = np.zeros(integrator.STATES)
    start[integrator.THETA] = start[integrator.THETA_LOAD] = np.deg2rad(commands.start_deg)
    if commands.before_pct == 0.0:
        return start
    states = np.zeros((2, integrator.STATES))
    integrator.integrate(
        as_record(motor),
        start,
        np.array([-SPIN_UP_S, 0.0]),
        np.full(2, commands.before_pct / 100.0),
        np.zeros(2, dtype=np.int64),
        np.zeros(2),
        states,
        np.zeros(2),
    )
    return np.asarray(states[1], dtype=np.float64)
