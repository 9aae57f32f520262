"""The goals that a brick's motor follows: recorded ones, or those of the firmware's speed regulation."""

from __future__ import annotations

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.errors import RecordingError
from nxt_twin.recording.columns import (
    REGULATIONS,
    Port,
    goal_column,
    power_column,
    regulation_column,
    tacho_column,
)
from nxt_twin.recording.recording import Recording

_DEG_PER_S_PER_PCT = 10.0
"""Firmware 1.29, d_output.c: in 100 ms the setpoint moves by as many counts as the set speed has percent."""


def regulated(recording: Recording, port: str) -> BoolArray:
    """In which rows the firmware regulates the speed of a port's motor."""
    regulation = recording.columns.get(regulation_column(_port(port)), np.zeros(recording.rows))
    return np.asarray(regulation == REGULATIONS.index("speed"))


def goal_deg(recording: Recording, port: str) -> FloatArray | None:
    """The goal from each row on, deg; None where the recording holds neither goals nor a regulated speed.

    Under speed regulation the firmware follows a setpoint that moves at the set speed, from where the motor was when
    the regulation began.

    Raises:
        RecordingError: the motor is regulated in some rows and driven by a plain power in others.
    """
    known = recording.columns.get(goal_column(_port(port)))
    if known is not None:
        return known
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
    return _setpoint_deg(recording, port, power, speed)


def _setpoint_deg(recording: Recording, port: str, power: FloatArray, speed: BoolArray) -> FloatArray:
    steps_s = np.diff(recording.time_s, append=recording.time_s[-1])
    moved = np.cumsum(_DEG_PER_S_PER_PCT * power * speed * steps_s)
    moved = np.concatenate([[0.0], moved[:-1]]) + 0.5 * _DEG_PER_S_PER_PCT * power * speed * steps_s
    tacho = recording.columns[tacho_column(_port(port))]
    read = np.flatnonzero(np.isfinite(tacho))
    where_it_was = np.interp(recording.time_s, recording.time_s[read], tacho[read])
    began = np.flatnonzero(speed & ~np.concatenate([[False], speed[:-1]]))
    latest = began[np.maximum(np.searchsorted(began, np.arange(recording.rows), side="right") - 1, 0)]
    return np.asarray(where_it_was[latest] + moved - np.concatenate([[0.0], moved])[latest])


def _port(port: str) -> Port:
    return port  # type: ignore[return-value]  # one of PORTS by now
