"""A case as a regression: accelerations from smoothed readings, the plain model's columns, and candidates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np
from scipy.signal import savgol_filter

from nxt_twin.arrays import FloatArray
from nxt_twin.recording.case import Case
from nxt_twin.recording.recording import Recording

RATE_HZ: Final = 100.0
SMOOTHED_S: Final = 0.13
SLOW_RAD_S: Final = 0.2
STRIBECK_RAD_S: Final = 1.5
WARM_S: Final = 5.0
DUTY_BEND: Final = 1.5
COGS: Final = (2, 3, 4, 6, 8, 12)
BINDINGS: Final = (1, 2, 3)


@final
@dataclass(frozen=True)
class Regression:
    """Rows of a case in which the motor is driven.

    Attributes:
        acceleration: what is to be explained, rad/s², shape (rows,).
        base: columns of the plain model: volts, and friction as far as the baseline has it.
        candidates: columns by effect and variant, each of shape (rows, k).
        speed: rad/s.
        volts: duty times supply.
        part: number of the half second to which a row belongs, so that halves of the data share no moment.
    """

    acceleration: FloatArray
    base: FloatArray
    candidates: dict[tuple[str, int], FloatArray]
    speed: FloatArray
    volts: FloatArray
    part: FloatArray

    def without_base(self, columns: FloatArray) -> FloatArray:
        """The columns after the plain model's columns are projected out."""
        fit, *_ = np.linalg.lstsq(self.base, columns, rcond=None)
        return np.asarray(columns - self.base @ fit)


def regression_of(case: Case) -> Regression:
    """The regression of everything that a case lets be fitted."""
    plant = case.plant if isinstance(case.plant, dict) else {}
    supply_v = float(plant.get("supply_v", 8.0))
    back_emf = float(plant.get("back_emf_v_s_per_rad", 0.49))
    parts = [_rows(recording, supply_v) for recording in case.recordings]
    rows = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    offsets = np.cumsum([0.0, *(part["time"][-1] + 1.0 for part in parts[:-1])])
    clock = np.concatenate([part["time"] + offset for part, offset in zip(parts, offsets, strict=True)])
    driven = rows["mode"] == 0.0
    rows = {name: values[driven] for name, values in rows.items()}
    candidates = _candidates(rows, back_emf)
    base = [rows["volts"], rows["speed"]]
    if "coulomb_friction_nm" in plant:
        base.append(candidates.pop(("coulomb_friction", 0))[:, 0])
    if "viscous_friction_nm_s_per_rad" in plant:
        candidates.pop(("viscous_friction", 0))
    return Regression(
        rows["acceleration"],
        np.column_stack(base),
        candidates,
        rows["speed"],
        rows["volts"],
        np.floor(2.0 * clock[driven]),
    )


def _rows(recording: Recording, supply_v: float) -> dict[str, FloatArray]:
    """One recording on an even grid, with speed and acceleration by local polynomials."""
    time_s = recording.time_s
    rate = min(RATE_HZ, 1.0 / max(float(np.median(np.diff(time_s))), 1e-3))
    grid = np.arange(time_s[0], time_s[-1], 1.0 / rate)
    angle = np.deg2rad(np.interp(grid, time_s, recording.columns["a_tacho_deg"]))
    window = max(5, 2 * int(0.5 * SMOOTHED_S * rate) + 1)
    held = np.clip(np.searchsorted(time_s, grid, side="right") - 1, 0, None)
    battery = recording.columns.get("battery_v", np.full(time_s.size, np.nan))
    known = ~np.isnan(battery)
    open_v = float(np.median(battery[known])) if known.any() else supply_v
    # The input is smoothed as the accelerations are, so that both belong to the same moments.
    duty = savgol_filter(recording.columns["a_power_pct"][held] / 100.0, window, 3)

    def derived(order: int) -> FloatArray:
        return np.asarray(savgol_filter(angle, window, 3, deriv=order, delta=1.0 / rate))

    return {
        "time": grid - grid[0],
        "angle": derived(0),
        "speed": derived(1),
        "acceleration": derived(2),
        "duty": np.asarray(duty, dtype=np.float64),
        "volts": np.asarray(duty * open_v, dtype=np.float64),
        "mode": recording.columns.get("a_mode", np.zeros(time_s.size))[held],
    }


def _candidates(rows: dict[str, FloatArray], back_emf: float) -> dict[tuple[str, int], FloatArray]:
    """Columns by effect and variant; what has memory or stands outside a torque balance has none."""
    angle, speed, volts, duty = rows["angle"], rows["speed"], rows["volts"], rows["duty"]
    way = np.tanh(speed / SLOW_RAD_S)
    drive = volts - back_emf * speed
    alone: dict[str, Any] = {
        "coulomb_friction": way,
        "viscous_friction": speed,
        "constant_load": np.ones(speed.size),
        "asymmetric_friction": np.abs(way),
        "quadratic_drag": speed * np.abs(speed),
        "spring_load": angle,
        "stiction": np.exp(-((speed / STRIBECK_RAD_S) ** 2)) * way,
        "load_dependent_friction": np.abs(drive) * way,
        "voltage_drop": np.tanh(drive),
        "power_curve": np.sign(duty) * np.abs(duty) ** DUTY_BEND,
        "battery_sag": duty * duty * drive,
        "friction_warmup": np.exp(-rows["time"] / WARM_S) * way,
    }
    columns = {(effect, 0): np.asarray(one)[:, None] for effect, one in alone.items()}
    columns["gravity_load", 1] = np.column_stack([np.sin(angle), np.cos(angle)])
    for n in COGS:
        columns["cogging", n] = np.column_stack([np.sin(n * angle), np.cos(n * angle)])
    for n in BINDINGS:
        columns["angle_dependent_friction", n] = (
            np.column_stack([np.sin(n * angle), np.cos(n * angle)]) * way[:, None]
        )
    return columns


EXPRESSED: Final = (
    "coulomb_friction",
    "viscous_friction",
    "constant_load",
    "asymmetric_friction",
    "quadratic_drag",
    "spring_load",
    "stiction",
    "load_dependent_friction",
    "voltage_drop",
    "power_curve",
    "battery_sag",
    "friction_warmup",
    "gravity_load",
    "cogging",
    "angle_dependent_friction",
)
"""Effects that a regression of the acceleration can express at all."""
