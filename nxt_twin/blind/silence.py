"""How far true clean motors are from the plainest model: what remains of windows after its best fit."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, final

import numpy as np
from scipy.optimize import least_squares

from nxt_twin.arrays import FloatArray
from nxt_twin.blind.families.compiled import compiled
from nxt_twin.blind.verdict import HOME, read_sealed
from nxt_twin.recording.case import read_case
from nxt_twin.recording.recording import Recording

WINDOW_S: Final = 2.0
STEP_S: Final = 2.5e-4
LAST_ROWS: Final = 6
NUDGE_RAD_S: Final = 0.05
ROUNDS: Final = 2
FURTHEST: Final = 1.0
MOST_TRIALS: Final = 15
QUICK_S: Final = 2e-4
DRIVE, FLOAT, COAST = 0.0, 1.0, 2.0


@final
@dataclass(frozen=True)
class Remains:
    """The remaining errors of one case.

    Attributes:
        rms_deg: over all windows.
        worst_deg: RMS of the worst window.
        step_deg: the encoder's step, to hold it against.
    """

    rms_deg: float
    worst_deg: float
    step_deg: float


@final
@dataclass(frozen=True)
class _Windows:
    """Windows of a recording: rows from `first` to `last`, and what was in force."""

    time_s: FloatArray
    true_rad: FloatArray
    duty: FloatArray
    supply_v: FloatArray
    mode: FloatArray
    first: FloatArray
    last: FloatArray


def remains_of(cases_dir: Path, answers_dir: Path) -> Iterator[tuple[str, str, Remains]]:
    """Family, name and remains of every clean case of a folder.

    Raises:
        CaseError: if an answer is not what was sealed with its case.
    """
    for file in sorted(answers_dir.glob("*.json")):
        answer = read_sealed(file, cases_dir / file.stem)
        if not answer["effects"]:
            case = read_case(cases_dir / file.stem)
            family = str(answer.get("family", HOME))
            yield family, file.stem, remains((*case.recordings, *case.holdout), answer)


def remains(recordings: Sequence[Recording], answer: Mapping[str, Any]) -> Remains:
    """Fit the plain motor to the true angles of a clean case in windows of 2 s, start speeds free.

    Args:
        recordings: of the case.
        answer: its answer, with the true angles.
    """
    parts = [_windows(recording, answer) for recording in recordings]
    base = answer["base"]
    constant, ohm, inertia = (
        base[key] for key in ("torque_constant_nm_per_a", "resistance_ohm", "inertia_kg_m2")
    )
    start = [
        constant / (ohm * inertia),
        constant,
        base["viscous_friction_nm_s_per_rad"] / inertia,
        base["coulomb_friction_nm"] / inertia,
        base["inductance_h"] / ohm,
    ]

    def off(logs: FloatArray) -> FloatArray:
        numbers = np.exp(logs)
        return np.concatenate([_misses(part, numbers) for part in parts])

    logs = np.log(start)
    bounds = (logs - FURTHEST, logs + FURTHEST)
    fit = least_squares(
        off, logs, bounds=bounds, loss="soft_l1", f_scale=math.radians(0.5), max_nfev=MOST_TRIALS
    )
    misses = np.rad2deg(off(fit.x))
    edges = np.cumsum(
        [int(last - first) for part in parts for first, last in zip(part.first, part.last, strict=True)]
    )
    each = [float(np.sqrt(np.mean(one**2))) for one in np.split(misses, edges[:-1])]
    return Remains(float(np.sqrt(np.mean(misses**2))), max(each), float(answer.get("step_deg", 1.0)))


def _windows(recording: Recording, answer: Mapping[str, Any]) -> _Windows:
    time_s = recording.time_s
    volts = recording.columns["battery_v"]
    known = ~np.isnan(volts)
    supply = np.polyval(np.polyfit(time_s[known], volts[known], 1 if known.sum() > 3 else 0), time_s)
    starts_s = np.arange(time_s[0], time_s[-1] - 0.5, WINDOW_S)
    first = np.searchsorted(time_s, starts_s)
    last = np.append(first[1:], time_s.size)
    long = last - first >= LAST_ROWS
    return _Windows(
        time_s,
        np.deg2rad(np.array(answer["recordings"][recording.name]["hub_deg"])),
        recording.columns["a_power_pct"] / 100.0,
        np.asarray(supply, dtype=np.float64),
        recording.columns.get("a_mode", np.zeros(time_s.size)),
        first[long].astype(np.float64),
        last[long].astype(np.float64),
    )


def _misses(part: _Windows, numbers: FloatArray) -> FloatArray:
    """Model minus truth (rad) in all windows, the start speed of each being the best for it."""
    out = []
    for first, last in zip(part.first.astype(int), part.last.astype(int), strict=True):
        rows = slice(first, last)
        held = (part.time_s[rows], part.duty[rows], part.supply_v[rows], part.mode[rows])
        true = part.true_rad[rows]
        ahead = min(4, true.size - 1)
        speed = (true[ahead] - true[0]) / (held[0][ahead] - held[0][0])
        for _ in range(ROUNDS):
            miss = _plain(numbers, true[0], speed, *held) - true
            slope = (_plain(numbers, true[0], speed + NUDGE_RAD_S, *held) - true - miss) / NUDGE_RAD_S
            speed -= float(slope @ miss) / (float(slope @ slope) + 1e-12)
        out.append(_plain(numbers, true[0], speed, *held) - true)
    return np.concatenate(out)


@compiled
def _goal(emf: float, duty: float, supply_v: float, mode: float) -> float:
    """Where ohm times current (V) goes: driven or braked, or with an open off phase, which it leaves one way only."""
    if mode == FLOAT:
        side = 1.0 if duty > 0.0 else -1.0
        return duty * max(0.0, supply_v - side * emf)
    return (duty * supply_v if mode == DRIVE else 0.0) - emf


@compiled
def _plain(
    numbers: FloatArray,
    angle: float,
    speed: float,
    time_s: FloatArray,
    duty: FloatArray,
    supply_v: FloatArray,
    mode: FloatArray,
) -> FloatArray:
    """Angles (rad) of a motor with winding, viscous and Coulomb friction, from a start, at the rows."""
    gain, constant, viscous, coulomb, lag_s = numbers
    out = np.zeros(time_s.size)
    out[0] = angle
    drive = 0.0 if mode[0] == COAST else _goal(constant * speed, duty[0], supply_v[0], mode[0])
    for row in range(1, time_s.size):
        span = time_s[row] - time_s[row - 1]
        steps = max(1, math.ceil(span / STEP_S))
        h = span / steps
        kept = math.exp(-h / (QUICK_S if mode[row - 1] in (FLOAT, COAST) else lag_s))
        for _ in range(steps):
            goal = 0.0
            if mode[row - 1] != COAST:
                goal = _goal(constant * speed, duty[row - 1], supply_v[row - 1], mode[row - 1])
            drive = goal + (drive - goal) * kept
            free = speed + h * (gain * drive - viscous * speed)
            speed = math.copysign(max(0.0, abs(free) - h * coulomb), free)
            angle += h * speed
        out[row] = angle
    return out
