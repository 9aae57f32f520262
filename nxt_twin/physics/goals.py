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

_PERIOD_S = 0.101
"""Of the firmware's regulator, which runs when 100 ms have passed. Firmware 1.29, d_output.c."""
_DEG_PER_PCT = 1.0
"""In a period the setpoint moves by as many counts as the set speed, at the period's end, has percent."""


def regulated(recording: Recording, port: str) -> BoolArray:
    """In which rows the firmware regulates the speed of a port's motor."""
    regulation = recording.columns.get(regulation_column(_port(port)), np.zeros(recording.rows))
    return np.asarray(regulation == REGULATIONS.index("speed"))


def goal_deg(recording: Recording, port: str) -> FloatArray | None:
    """The goal from each row on, deg; None where the recording holds neither goals nor a regulated speed.

    Under speed regulation the firmware follows a setpoint. It begins at the motor's angle and moves by the set speed
    once a period. At a set speed of 0 nothing is regulated.

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
    time_s, tacho = recording.time_s, recording.columns[tacho_column(_port(port))]
    read = np.flatnonzero(np.isfinite(tacho))
    goal = np.interp(time_s, time_s[read], tacho[read])
    active = speed & (power != 0.0)
    edges = np.flatnonzero(np.diff(active.astype(int), prepend=0, append=0))
    for first, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        at_s = np.arange(time_s[first] + _PERIOD_S, time_s[end - 1] + _PERIOD_S, _PERIOD_S)
        in_force = power[first + np.searchsorted(time_s[first:end], at_s, side="right") - 1]
        moved = np.concatenate([[0.0], np.cumsum(_DEG_PER_PCT * in_force)])
        own_s = time_s[first:end]
        run = np.searchsorted(at_s, own_s, side="right")  # how often the regulator has run
        # Until it runs again it goes by the count of then: a loop that goes by that of now is given a ramp.
        since = (own_s - time_s[first]) / _PERIOD_S - run
        ramp = np.concatenate([[0.0], _DEG_PER_PCT * in_force])[run] * since
        goal[first:end] = goal[first] + moved[run] + ramp
    return goal


def _port(port: str) -> Port:
    return port  # type: ignore[return-value]  # one of PORTS by now
