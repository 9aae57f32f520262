"""A host in front of a machine: it polls, commands, and writes rows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.blind.families.beginnings import BeginningName
from nxt_twin.blind.families.habits import Habits
from nxt_twin.blind.families.machine import Machine
from nxt_twin.blind.families.numbers import Chain
from nxt_twin.blind.families.programs import Loop, Played, Program
from nxt_twin.recording.recording import Recording

BATTERY_NOISE_V = 0.006
BATTERY_STEP_V = 0.01

HUB, MISCOUNT, VOLTS = range(3)


@final
@dataclass(frozen=True)
class Script:
    """One recording before it is made: when it is polled and what is to be done.

    Attributes:
        name: of the file.
        program: the name of the kind of program.
        begins: the name of the kind of beginning.
        read_s: true times of the polls, shape (polls,); those before zero are not recorded.
        start_deg: hub angle at the first poll, where the machine is at rest.
        ahead_s: how far the program is at the first poll, s.
        make_program: makes the program, which may keep what it has read.
    """

    name: str
    program: str
    begins: BeginningName
    read_s: FloatArray
    start_deg: float
    ahead_s: float
    make_program: Callable[[], Program]

    @property
    def program_s(self) -> FloatArray:
        """The program's own time at each poll, s."""
        return np.asarray(self.read_s - self.read_s[0] + self.ahead_s)


@final
@dataclass(frozen=True)
class Driven:
    """Commands and the machine's motion; arrays have shape (polls,).

    Attributes:
        duty_pct: commanded at each poll.
        mode: likewise.
        states: hub angle, miscount, volts at each reading, shape (polls, 3).
    """

    duty_pct: FloatArray
    mode: IntArray
    states: FloatArray


def drive_machine(
    machine: Machine, chain: Chain, script: Script, step_deg: float, command_every_s: float = 0.0
) -> Driven:
    """Run a machine through a script; a program that closes a loop sees what the encoder shows.

    Commands that are known beforehand change no more often than `command_every_s`.
    """
    program = script.make_program()
    if isinstance(program, Played):
        table = program.table(script.program_s)
        if command_every_s > 0.0:
            turn = np.floor(script.read_s / command_every_s)
            rows = np.searchsorted(turn, turn, side="left")
            table = (table[0][rows], table[1][rows])
        return Driven(*table, follow(machine, chain, script, *table))
    return _loop(machine, chain, script, program, step_deg)


def follow(
    machine: Machine, chain: Chain, script: Script, duty_pct: FloatArray, mode: IntArray
) -> FloatArray:
    """Hub angle, miscount and volts at each reading under commands that are known, shape (polls, 3)."""
    read_s = script.read_s
    act_s = acting_s(chain, read_s)
    changed = np.concatenate([[True], (np.diff(duty_pct) != 0.0) | (np.diff(mode) != 0)])
    rows = np.flatnonzero(changed & (act_s < read_s[-1]))
    edges_s = np.concatenate([[read_s[0]], act_s[rows], [read_s[-1]]])
    duties, modes = np.concatenate([[0.0], duty_pct[rows]]), np.concatenate([[0], mode[rows]])
    states = np.zeros((read_s.size, 3))
    states[0] = machine.run(read_s[:1], 0.0, 0)[0]
    for piece in range(duties.size):
        low_s, high_s = edges_s[piece], edges_s[piece + 1]
        if high_s <= low_s:
            continue
        inside = np.flatnonzero((read_s > low_s) & (read_s <= high_s))
        stops_s = np.append(read_s[inside], high_s)
        states[inside] = machine.run(stops_s, float(duties[piece]) / 100.0, int(modes[piece]))[: inside.size]
    return states


def acting_s(chain: Chain, read_s: FloatArray) -> FloatArray:
    """When the command of each poll acts, s."""
    return np.asarray(np.maximum.accumulate(read_s + chain.lag_s(read_s) + chain.delay_s))


def _loop(machine: Machine, chain: Chain, script: Script, program: Loop, step_deg: float) -> Driven:
    read_s, program_s = script.read_s, script.program_s
    act_s = acting_s(chain, read_s)
    duty_pct, states = np.zeros(read_s.size), np.zeros((read_s.size, 3))
    in_force, next_one, now_s = 0.0, 0, float(read_s[0])
    states[0] = machine.run(read_s[:1], 0.0, 0)[0]
    for row, until_s in enumerate(read_s):
        while next_one < row and act_s[next_one] <= until_s:
            if act_s[next_one] > now_s:
                now_s = float(act_s[next_one])
                machine.run(np.array([now_s]), in_force, 0)
            in_force = duty_pct[next_one] / 100.0
            next_one += 1
        if until_s > now_s:
            now_s = float(until_s)
            states[row] = machine.run(np.array([now_s]), in_force, 0)[0]
        elif row:
            states[row] = machine.run(np.array([now_s]), in_force, 0)[0]
        shown = chain.encoder_deg(*np.rad2deg(states[row : row + 1, :VOLTS].T))[0]
        duty_pct[row] = program.command(float(program_s[row]), float(np.floor(shown / step_deg) * step_deg))
    return Driven(duty_pct, np.zeros(read_s.size, dtype=np.int64), states)


def shown_deg(chain: Chain, states: FloatArray) -> FloatArray:
    """The encoder's reading before it is cut to its steps."""
    return chain.encoder_deg(*np.rad2deg(states[:, :VOLTS].T))


@final
@dataclass(frozen=True)
class Rows:
    """A recording, and the truth behind it.

    Attributes:
        recording: what the solver gets.
        hub_deg: the hub's true angle when each reading was taken.
        read_deg: the encoder before its steps, with what is stale.
    """

    recording: Recording
    hub_deg: FloatArray
    read_deg: FloatArray


def write_rows(rng: Generator, script: Script, chain: Chain, habits: Habits, driven: Driven) -> Rows:
    """Make rows of what a machine did from time zero on: stamps, steps, stale readings, the battery, late rows."""
    first = int(np.searchsorted(script.read_s, 0.0))
    issued_s = script.read_s + chain.lag_s(script.read_s)
    read_deg = _taken(rng, chain, script.read_s, shown_deg(chain, driven.states))[first:]
    late = int(chain.late_rows)
    duty, mode = (np.concatenate([np.zeros(late), one])[: one.size] for one in (driven.duty_pct, driven.mode))
    every = 0 if chain.battery_once else habits.battery_every
    columns = {
        "time_s": np.round((1.0 + chain.rate_error) * issued_s[first:], 6),
        "a_power_pct": duty[first:],
        "a_tacho_deg": np.round(np.floor(read_deg / habits.step_deg) * habits.step_deg, 6),
        "battery_v": _battery(rng, driven.states[first:, VOLTS], every),
    }
    if np.any(mode[first:]):
        columns["a_mode"] = mode[first:].astype(np.float64)
    return Rows(Recording(script.name, columns), np.rad2deg(driven.states[first:, HUB]), read_deg)


def _taken(rng: Generator, chain: Chain, read_s: FloatArray, shown: FloatArray) -> FloatArray:
    """What each row gets: what is shown now, at the device's last refresh, or in the row before."""
    if chain.refresh_period_s > 0.0:
        refreshed_s = np.floor(read_s / chain.refresh_period_s) * chain.refresh_period_s
        return np.asarray(np.interp(refreshed_s, read_s, shown), dtype=np.float64)
    stale = rng.random(read_s.size) < chain.stale_fraction
    rows = np.maximum.accumulate(np.where(stale, 0, np.arange(read_s.size)))
    return np.asarray(shown[rows], dtype=np.float64)


def _battery(rng: Generator, volts: FloatArray, every: int) -> FloatArray:
    noisy = volts + BATTERY_NOISE_V * rng.standard_normal(volts.size)
    read = np.zeros(volts.size, dtype=bool)
    read[:: every or volts.size] = True
    return np.asarray(np.where(read, np.round(np.floor(noisy / BATTERY_STEP_V) * BATTERY_STEP_V, 3), np.nan))
