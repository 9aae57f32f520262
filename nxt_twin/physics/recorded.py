"""The signals of a recording: one axis of a bench, or one motor of a brick beside the others on its battery."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.errors import RecordingError
from nxt_twin.physics.clumped import as_read
from nxt_twin.physics.evenly import evenly_read
from nxt_twin.physics.goals import Setpoints, goal_deg, regulated, setpoints
from nxt_twin.physics.held_stamps import without_held_stamps
from nxt_twin.physics.modes import MODE_BRAKE, MODE_COAST, MODE_CURRENT, MODE_DRIVE, MODE_VOLTAGE
from nxt_twin.physics.others import with_others
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.supply import open_circuit
from nxt_twin.recording.clumps import told_apart_s
from nxt_twin.recording.columns import PORTS, power_column, tacho_column
from nxt_twin.recording.lags import KnownLags
from nxt_twin.recording.pulses import pulsed
from nxt_twin.recording.recording import GOALS, InputKind, Recording
from nxt_twin.recording.tacho_steps import tacho_step_deg

_FEWEST_READINGS = 10
_SUPPLY_RESOLUTION = 2e-3  # a change of supply below this fraction starts no new command
_MEASURED_SHARE = 0.8  # of the rows with a supply reading, above which the supply is used as measured


def signals_of(
    recording: Recording,
    port: str | None,
    fewest_readings: int = _FEWEST_READINGS,
    *,
    follows_goal: bool = False,
) -> Signals:
    """The signals of one axis of a recording.

    Args:
        recording: a brick's recording or a mapped one.
        port: `a`, `b` or `c` for a brick's; ignored for a mapped one.
        fewest_readings: that it has to hold; 0 for commands alone.
        follows_goal: what drives it is the goal, where a power is recorded too.

    Raises:
        RecordingError: the port was not driven or not read, or nothing was read at all.
    """
    recording = replace(
        recording, columns={**recording.columns, "time_s": told_apart_s(recording.columns["time_s"])}
    )
    if fewest_readings == 0:
        recording = _with_empty_output(recording, port or "a")
    axis = port or "a"
    found = (
        _mapped(recording) if recording.kinds else _beside_others(recording, axis, follows_goal=follows_goal)
    )
    if np.isfinite(found.measured).sum() < fewest_readings:
        raise RecordingError(
            f"fewer than {fewest_readings} readings",
            where=f"{recording.name}, column {found.channel}",
            mend="record for longer",
        )
    read = evenly_read(as_read(found))
    return without_held_stamps(
        replace(read, command_polls=np.zeros((0, 2)))
    )  # polls as they were, not as stamped


def _with_empty_output(recording: Recording, port: str) -> Recording:
    """The recording, with a column of the output where it has none."""
    output = "output" if recording.kinds else f"{port}_tacho_deg"
    if output in recording.columns:
        return recording
    return replace(recording, columns={**recording.columns, output: np.full(recording.rows, np.nan)})


def _beside_others(recording: Recording, port: str, *, follows_goal: bool) -> Signals:
    """One motor's signals beside all others of which both commands and counts are known."""
    columns, nothing = recording.columns, np.zeros(0)
    others = [
        _on_its_port(recording, other, follows_goal=False)
        for other in PORTS
        if other != port
        and power_column(other) in columns
        and not regulated(recording, other).any()
        and np.isfinite(columns.get(tacho_column(other), nothing)).sum() >= _FEWEST_READINGS
    ]
    return with_others(_on_its_port(recording, port, follows_goal=follows_goal), others)


def _on_its_port(recording: Recording, port: str, *, follows_goal: bool) -> Signals:
    followed = setpoints(recording, port)
    if followed is not None:
        return _dated(_regulated(recording, port, followed), recording.lags, port)
    goal = goal_deg(recording, port)
    if goal is None or (f"{port}_power_pct" in recording.columns and not follows_goal):
        return _dated(_brick(recording, port), recording.lags, port)
    return _dated(_following(recording, port, np.radians(goal)), recording.lags, port)


def _following(recording: Recording, port: str, goal: FloatArray) -> Signals:
    """The signals of a motor that a loop brings to a goal, rad; off wherever its mode says so."""
    known = goal[np.isfinite(goal)]
    command = _held(goal, start=float(known[0]) if known.size else 0.0)
    mode = _held(recording.columns.get(f"{port}_mode", np.zeros(recording.rows)), start=float(MODE_DRIVE))
    supply = _supply(recording.time_s, recording.columns.get("battery_v"), np.zeros(recording.rows))
    return _of_motor(recording, port, "goal_position_rad", (command, mode, supply))


def _regulated(recording: Recording, port: str, followed: Setpoints) -> Signals:
    """The signals of a motor whose speed the firmware regulates: a command whenever its regulator runs."""
    nothing = np.zeros(recording.rows)
    supply = _supply(recording.time_s, recording.columns.get("battery_v"), nothing)
    whole = _of_motor(recording, port, "goal_position_rad", (nothing, nothing, supply))
    return replace(
        whole,
        command_time_s=followed.time_s,
        command=np.radians(followed.goal_deg),
        command_mode=np.where(followed.driven, MODE_DRIVE, MODE_BRAKE),
        command_supply_v=supply[followed.row],
    )


def _of_motor(
    recording: Recording, port: str, kind: InputKind, in_force: tuple[FloatArray, FloatArray, FloatArray]
) -> Signals:
    """A motor's signals from command, mode and supply in each row, shape (rows,) each."""
    tacho = f"{port}_tacho_deg"
    command, mode, supply = in_force
    keep = _changes(command, mode, supply)
    return Signals(
        name=recording.name,
        channel=tacho,
        input_kind=kind,
        command_time_s=recording.time_s[keep],
        command=command[keep],
        command_mode=mode[keep].astype(np.int64),
        command_supply_v=supply[keep],
        time_s=np.array(recording.time_s),
        measured=np.radians(recording.columns[tacho]),
        is_speed=False,
        quantum=math.radians(tacho_step_deg(recording, port)),
    )


def _brick(recording: Recording, port: str) -> Signals:
    power, tacho = f"{port}_power_pct", f"{port}_tacho_deg"
    for column in (power, tacho):
        if column not in recording.columns:
            raise RecordingError(
                "no such column", where=f"{recording.name}, column {column}", mend="name another port"
            )
    rows = recording.rows
    duty = pulsed(_held(recording.columns[power], start=0.0) / 100.0, recording.pulse_steps)
    mode = _held(recording.columns.get(f"{port}_mode", np.zeros(rows)), start=float(MODE_DRIVE))
    supply = _supply(recording.time_s, recording.columns.get("battery_v"), _effort(recording))
    return _of_motor(recording, port, "power_pct", (duty, mode, supply))


def _dated(signals: Signals, lags: KnownLags, port: str) -> Signals:
    """A brick's signals with each reading and command at its own moment, as far as the sidecar gives the lags."""
    read_before_s, _ = lags.read_before_s(port)
    acted_after_s, _ = lags.acted_after_s(port)
    taken_s, acted_s = signals.time_s - read_before_s, signals.command_time_s + acted_after_s
    if acted_after_s <= 0.0:
        return replace(signals, time_s=taken_s, command_time_s=acted_s)
    # Nothing drives what is read in the first row: its command acts later.
    return replace(
        signals,
        time_s=taken_s,
        command_time_s=np.insert(acted_s, 0, taken_s[0]),
        command=np.insert(signals.command, 0, 0.0),
        command_mode=np.insert(signals.command_mode, 0, MODE_COAST),
        command_supply_v=np.insert(signals.command_supply_v, 0, signals.command_supply_v[0]),
    )


def _mapped(recording: Recording) -> Signals:
    kinds = recording.kinds
    if kinds is None:
        raise RecordingError("is not a mapped recording", where=recording.name)
    command = _held(recording.columns["input"], start=0.0)
    if kinds.input == "power_pct":
        command = command / 100.0
    mode = _mapped_mode(recording, kinds.input)
    if kinds.input in ("torque_nm", "force_n"):  # a bench's torque is off where its drive is not on
        command = np.where((mode == MODE_COAST) | (mode == MODE_BRAKE), 0.0, command)
    effort = np.zeros(recording.rows) if kinds.input in GOALS else command
    supply = _supply(recording.time_s, recording.columns.get("supply_v"), effort)
    if kinds.input == "voltage_v":  # what no supply was recorded for had one that gave it
        supply = np.where(np.isfinite(supply), supply, np.abs(command).max(initial=0.0))
    keep = _changes(command, mode, supply)
    return Signals(
        name=recording.name,
        channel="output",
        input_kind=kinds.input,
        command_time_s=recording.time_s[keep],
        command=command[keep],
        command_mode=mode[keep].astype(np.int64),
        command_supply_v=supply[keep],
        time_s=np.array(recording.time_s),
        measured=np.array(recording.columns["output"]),
        is_speed=kinds.output.startswith("speed"),
        quantum=recording.output_quantum,
    )


def _mapped_mode(recording: Recording, kind: InputKind) -> FloatArray:
    """The bridge's mode in each row: as recorded, with a given voltage or current in the place of a duty."""
    driven = {"voltage_v": MODE_VOLTAGE, "current_a": MODE_CURRENT}.get(kind, MODE_DRIVE)
    recorded = recording.columns.get("mode", np.zeros(recording.rows))
    mode = _held(recorded, start=float(MODE_DRIVE))
    return np.where(mode == MODE_DRIVE, float(driven), mode)


def _held(values: FloatArray, *, start: float) -> FloatArray:
    """Fill cells that were not sampled with the value in force, `start` before the first."""
    known = np.isfinite(values)
    last = np.maximum.accumulate(np.where(known, np.arange(values.size), -1))
    filled: FloatArray = np.where(last >= 0, values[np.maximum(last, 0)], start)
    return filled


def _effort(recording: Recording) -> FloatArray:
    """The sum of the duties of all motors, which are on one battery, from each row on."""
    powers = [recording.columns[name] for name in map(power_column, PORTS) if name in recording.columns]
    effort: FloatArray = np.sum([np.abs(_held(power, start=0.0)) / 100.0 for power in powers], axis=0)
    return effort


def _supply(time_s: FloatArray, readings: FloatArray | None, command: FloatArray) -> FloatArray:
    """The supply: as measured where nearly every row has it, else a line of the open-circuit voltage.

    A reading shows whatever the motors drew at that moment; taken one by one, few readings would smuggle a part of the
    sag into the model, and their noise.
    """
    if readings is None or not np.isfinite(readings).any():
        return np.full(time_s.size, np.nan)
    known = np.isfinite(readings)
    if known.mean() >= _MEASURED_SHARE and np.unique(readings[known]).size > 1:
        return _held(readings, start=float(readings[known][0]))
    known &= np.nan_to_num(readings) > 0.0  # a logger writes 0 where it has read nothing
    if not known.any():
        return np.full(time_s.size, np.nan)
    effort = np.abs(np.concatenate([[0.0], command[:-1]]))  # a row is read before its own command acts
    level_v, slope_v_per_s = open_circuit(time_s[known], readings[known], effort[known])
    return level_v + slope_v_per_s * time_s


def _changes(command: FloatArray, mode: FloatArray, supply: FloatArray) -> BoolArray:
    keep = np.ones(command.size, dtype=bool)
    keep[1:] = (np.diff(command) != 0.0) | (np.diff(mode) != 0.0)
    drift = np.nan_to_num(supply / (supply[0] or 1.0) - 1.0) / _SUPPLY_RESOLUTION
    keep[1:] |= np.diff(np.round(drift)) != 0.0
    return keep
