"""The goals that a brick's motor follows: recorded ones, or those of the firmware's speed regulation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray
from nxt_twin.errors import RecordingError
from nxt_twin.physics.base.dc_motor import DC_MOTOR
from nxt_twin.physics.base.servo import SERVO
from nxt_twin.physics.effects.regulation import FIRMWARE_REGULATION
from nxt_twin.recording.columns import (
    REGULATIONS,
    Port,
    goal_column,
    power_column,
    regulation_column,
    tacho_column,
)
from nxt_twin.recording.recording import Recording

_PERIOD_S = 0.101
"""Of the firmware's regulator, which runs when 100 ms have passed. Firmware 1.29, d_output.c."""
_GAIN_KEY = "position_gain_pct_per_deg"
_MARK_DEG = 1e-6
"""A setpoint that stays moves by this whenever the regulator runs: a plant sees by it that it has."""
_DEG_PER_PCT = 1.0
"""In a period the setpoint moves by as many counts as the set speed, at the period's end, has percent."""


def regulated(recording: Recording, port: str) -> BoolArray:
    """In which rows the firmware regulates the speed of a port's motor."""
    regulation = recording.columns.get(regulation_column(_port(port)), np.zeros(recording.rows))
    return np.asarray(regulation == REGULATIONS.index("speed"))


def goal_deg(recording: Recording, port: str) -> FloatArray | None:
    """The goal from each row on, deg; None where the recording holds none."""
    return recording.columns.get(goal_column(_port(port)))


@final
@dataclass(frozen=True)
class Setpoints:
    """The firmware's setpoints: each from its moment on.

    Attributes:
        time_s: the moments, growing, shape (moments,).
        goal_deg: the setpoints.
        driven: whether the regulator drives the motor; where it does not, the motor brakes.
        row: the recording's row at that moment.
    """

    time_s: FloatArray
    goal_deg: FloatArray
    driven: BoolArray
    row: IntArray


def setpoints(recording: Recording, port: str) -> Setpoints | None:
    """The setpoints of the firmware's regulator; None where it regulates no speed of that motor.

    The setpoint begins at the motor's count and moves by the set speed once a period. Where the set speed becomes 0,
    the motor brakes for a period. Then the regulator holds it at the count at which that happened.

    Raises:
        RecordingError: the motor is regulated in some rows and driven by a plain power in others.
    """
    speed = regulated(recording, port)
    if not speed.any():
        return None
    power = recording.columns[power_column(_port(port))]
    if np.any((power != 0.0) & ~speed):
        where = f"{recording.name}, column {regulation_column(_port(port))}"
        mend = "split the recording where the regulation is switched"
        raise RecordingError(
            "has rows with a regulated speed and others with a plain power", where=where, mend=mend
        )
    time_s, tacho = recording.time_s, recording.columns[tacho_column(_port(port))]
    read = np.flatnonzero(np.isfinite(tacho))
    count = np.interp(time_s, time_s[read], tacho[read])
    moves = power != 0.0
    edges = [0, *(np.flatnonzero(np.diff(moves.astype(int))) + 1).tolist(), time_s.size]
    spans = [_span(time_s, power, count, rows) for rows in pairwise(edges)]
    return Setpoints(
        time_s=np.concatenate([span.time_s for span in spans]),
        goal_deg=np.concatenate([span.goal_deg for span in spans]),
        driven=np.concatenate([span.driven for span in spans]),
        row=np.concatenate([span.row for span in spans]),
    )


def _span(time_s: FloatArray, power: FloatArray, count: FloatArray, rows: tuple[int, int]) -> Setpoints:
    """The setpoints of rows in all of which the set speed is 0, or in none."""
    first, end = rows
    moves = power[first] != 0.0
    ended_s = time_s[end] if end < time_s.size else time_s[-1] + _PERIOD_S
    runs_s = np.arange(time_s[first] + _PERIOD_S, ended_s, _PERIOD_S)
    row = first + np.searchsorted(time_s[first:end], runs_s, side="right") - 1
    moved = np.cumsum(_DEG_PER_PCT * power[row]) if moves else _MARK_DEG * (np.arange(row.size) % 2 == 0)
    whole = Setpoints(
        np.concatenate([[time_s[first]], runs_s]),
        count[first] + np.concatenate([[0.0], moved]),
        np.concatenate([[moves], np.ones(row.size, dtype=bool)]),
        np.concatenate([[first], row]),
    )
    if moves and first > 0:  # until the regulator runs, its last output stays in force
        return Setpoints(whole.time_s[1:], whole.goal_deg[1:], whole.driven[1:], whole.row[1:])
    return whole


def follower(
    config: Mapping[str, Any], recordings: Sequence[Recording], port: str | None
) -> Mapping[str, Any]:
    """The plant that follows these recordings: where the firmware regulates the speed, a servo with its regulator.

    Args:
        config: a plant file's keys.
        recordings: of one motor.
        port: of that motor; None of a mapped recording.
    """
    if config.get("kind") not in ("dc_motor", SERVO.kind) or port is None:
        return config
    if not any(regulated(each, port).any() for each in recordings):
        return config
    gains = {each.name: each.starts[0] for each in FIRMWARE_REGULATION.parameters}
    loop = {each.name for each in SERVO.parameters} - {each.name for each in DC_MOTOR.parameters}
    motor = {key: value for key, value in config.items() if key not in loop}
    return {**gains, **motor, "kind": SERVO.kind, _GAIN_KEY: 0.0}


def _port(port: str) -> Port:
    return port  # type: ignore[return-value]  # one of PORTS by now
