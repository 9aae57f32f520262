"""The paper's way: steady speeds against voltage (equations 5, 6, 11), and coast-downs, without a simulation."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Final

import numpy as np
from scipy.optimize import least_squares

from nxt_twin.arrays import FloatArray
from nxt_twin.experiment.combine import propagated
from nxt_twin.experiment.identified import Value, normal_value
from nxt_twin.recording.columns import BATTERY, DRIVE_MODES, Port, mode_column, power_column, tacho_column
from nxt_twin.recording.recording import Recording

_SETTLED_S: Final = 0.6
_LEAST_STEADY_S: Final = 0.4
_LEAST_COAST_S: Final = 0.15
_LEAST_COAST_READINGS: Final = 10
_TURNING_RAD_PER_S: Final = 0.5
_LEAST_SPEEDS: Final = 3
_ROUNDING_DEG: Final = 1.0 / math.sqrt(12.0)


def steady_state(
    recordings: Sequence[Recording], port: Port, x: FloatArray, covariance: FloatArray
) -> tuple[tuple[Value, ...], tuple[str, ...]]:
    """Friction by the paper's method, beside the fit's.

    Args:
        recordings: with stretches of constant duty of a second or more, and coast-downs.
        port: the motor's.
        x: resistance, inertia, torque constant, viscous and Coulomb friction as identified, shape (5,); the first
            and the third are what the paper measured otherwise.
        covariance: of `x`.

    Returns:
        The values, and notes; none of the former where there are too few steady speeds.
    """
    speeds = [pair for recording in recordings for pair in _steady_speeds(recording, port)]
    if len(speeds) < _LEAST_SPEEDS:
        return (), ("There are too few steady speeds for the paper's own method.",)
    voltage, speed = np.array(speeds).T
    line, spread = np.polyfit(voltage, speed, 1, cov="unscaled")
    left = speed - np.polyval(line, voltage)
    spread = spread * float(left @ left) / max(voltage.size - 2, 1)
    names = ("speed_per_volt", "speed_at_0_v")
    values = [
        normal_value(f"paper_{name}", float(value), float(std), unit)
        for name, value, std, unit in zip(
            names, line, np.sqrt(np.diag(spread)), ("rad/s/V", "rad/s"), strict=True
        )
    ]
    values += _friction(line, spread, x, covariance)
    values += _coasting(recordings, port)
    return tuple(values), ()


def _friction(line: FloatArray, spread: FloatArray, x: FloatArray, covariance: FloatArray) -> list[Value]:
    """Equation 6, T = K·v_c/R, and equation 11's slope, 1/(R·B/K + K), solved for B."""
    both = np.concatenate([line, x[[0, 2]]])
    joint = np.zeros((4, 4))
    joint[:2, :2] = spread
    joint[2:, 2:] = covariance[np.ix_([0, 2], [0, 2])]

    def solved(m: FloatArray) -> FloatArray:
        slope, offset, resistance, constant = m
        return np.array(
            [constant * (-offset / slope) / resistance, constant * (1.0 / slope - constant) / resistance]
        )

    value, doubt = propagated(solved, both, joint)
    rests = "resistance and torque constant as identified"
    names = (("paper_coulomb_friction_nm", "N·m"), ("paper_viscous_friction_nm_s_per_rad", "N·m·s/rad"))
    return [
        normal_value(name, float(v), float(s), unit, rests)
        for (name, unit), v, s in zip(names, value, np.sqrt(np.diag(doubt)), strict=True)
    ]


def _coasting(recordings: Sequence[Recording], port: Port) -> list[Value]:
    """B/J and T/J from the angles of every coast-down: ω falls as (ω0 + c/b)·exp(-b·t) - c/b."""
    downs = [down for recording in recordings for down in _coast_downs(recording, port)]
    if not downs:
        return []

    def left(p: FloatArray) -> FloatArray:
        rate, steady = np.exp(p[:2])
        parts = []
        for n, (time_s, angle) in enumerate(downs):
            start, speed = p[2 + 2 * n : 4 + 2 * n]
            fallen = (speed + steady / rate) * -np.expm1(-rate * time_s) / rate - steady * time_s / rate
            parts.append((angle - start - fallen) / math.radians(_ROUNDING_DEG))
        return np.concatenate(parts)

    begin = [math.log(1.0), math.log(8.0)]
    for time_s, angle in downs:
        begin += [float(angle[0]), float((angle[4] - angle[0]) / (time_s[4] - time_s[0]))]
    best = least_squares(left, np.array(begin), x_scale="jac")
    spread = np.linalg.pinv(best.jac.T @ best.jac)[:2, :2] * max(
        1.0, 2.0 * best.cost / max(best.fun.size - len(begin), 1)
    )
    value = np.exp(best.x[:2])
    stds = value * np.sqrt(np.diag(spread))
    names = (("coasting_viscous_over_inertia", "1/s"), ("coasting_coulomb_over_inertia", "rad/s²"))
    return [
        normal_value(name, float(v), float(s), unit)
        for (name, unit), v, s in zip(names, value, stds, strict=True)
    ]


def _stretches(recording: Recording, port: Port) -> Iterator[tuple[slice, float, str]]:
    """Rows under one command, its duty -1 to 1 and its mode."""
    power, mode = recording.columns[power_column(port)], recording.columns[mode_column(port)]
    edges = np.flatnonzero((np.diff(power) != 0.0) | (np.diff(mode) != 0.0)) + 1
    bounds = [0, *edges.tolist(), power.size]
    for low, high in pairwise(bounds):
        # The row of the next command was read before it acts, and so belongs to this one.
        yield slice(low, min(high + 1, power.size)), float(power[low]) / 100.0, DRIVE_MODES[int(mode[low])]


def _steady_speeds(recording: Recording, port: Port) -> Iterator[tuple[float, float]]:
    """Voltage and speed of each stretch in which the motor turned evenly; both counted positive."""
    battery = recording.columns[BATTERY]
    supply_v = float(np.nanmedian(battery)) if np.isfinite(battery).any() else math.nan
    for rows, duty, mode in _stretches(recording, port):
        time_s = recording.time_s[rows]
        late = time_s > time_s[0] + _SETTLED_S
        if mode != "drive" or duty == 0.0 or not late.any() or not math.isfinite(supply_v):
            continue
        if time_s[-1] - time_s[late][0] < _LEAST_STEADY_S:
            continue
        angle = np.deg2rad(recording.columns[tacho_column(port)][rows])
        speed = abs(float(np.polyfit(time_s[late], angle[late], 1)[0]))
        if speed > _TURNING_RAD_PER_S:
            yield abs(duty) * supply_v, speed


def _coast_downs(recording: Recording, port: Port) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Times since the start and angles, counted positive, of each coast-down, while it is turning."""
    for rows, _, mode in _stretches(recording, port):
        if mode != "coast":
            continue
        time_s = recording.time_s[rows] - recording.time_s[rows][0]
        angle = np.deg2rad(recording.columns[tacho_column(port)][rows])
        angle = np.abs(angle - angle[0])
        later = np.interp(time_s + 0.05, time_s, angle)
        turning = (later - angle) / 0.05 > _TURNING_RAD_PER_S * 2.0
        # What follows the link's delay is still driven; where it has nearly stopped, friction is another.
        used = (time_s > 0.02) & np.logical_and.accumulate(turning | (time_s <= 0.02))
        if used.sum() >= _LEAST_COAST_READINGS and np.ptp(time_s[used]) > _LEAST_COAST_S:
            yield time_s[used] - time_s[used][0], angle[used]
