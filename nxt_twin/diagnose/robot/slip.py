"""Spells in which a wheel turned without travel: located, and taken out of the wheels' angles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray
from nxt_twin.diagnose.robot.runs import RobotRun
from nxt_twin.physics.robot.drive import Geometry

Side = Literal["left", "right"]

_WINDOW_S: Final = 1.0
_FINE_S: Final = 0.4
_SIGMAS: Final = 7.0
_LEAST_RATIO: Final = 0.06
_LEAST_LOST_M: Final = 2e-3
_KEPT: Final = 0.6
_REACH_S: Final = 4.0
_ALIKE: Final = 0.15
_MAD: Final = 1.4826


@final
@dataclass(frozen=True)
class SlipSpell:
    """One spell of one wheel.

    Attributes:
        run: index of the run; `recording` its name.
        side: which wheel.
        start_s, end_s: on the recording's clock.
        ratio: of the wheel's travel that was lost, with its standard deviation.
        strength: of the lost travel, in standard deviations.
    """

    run: int
    recording: str
    side: Side
    start_s: float
    end_s: float
    ratio: float
    std: float
    strength: float


def find_slip(
    runs: Sequence[RobotRun], geometry: Geometry, wheels: Sequence[tuple[FloatArray, FloatArray]]
) -> tuple[SlipSpell, ...]:
    """Spells in which wheels turned without travel.

    Args:
        runs: the recordings.
        geometry: the fitted robot.
        wheels: angles of each run's wheels when its poses were taken.
    """
    found: list[SlipSpell] = []
    lost = [_lost(run, geometry, angles, _WINDOW_S) for run, angles in zip(runs, wheels, strict=True)]
    pooled = np.concatenate([each.lost for each in lost], axis=1)
    scale = np.maximum(_MAD * np.median(np.abs(pooled - np.median(pooled, axis=1)[:, None]), axis=1), 1e-4)
    for index, (run, angles) in enumerate(zip(runs, wheels, strict=True)):
        for wheel, side in enumerate(("left", "right")):
            found += _of_wheel(index, run, geometry, angles, lost[index], wheel, side, float(scale[wheel]))
    return tuple(sorted(found, key=lambda slip: -slip.strength))


def without_slip(run: RobotRun, slips: Sequence[SlipSpell]) -> RobotRun:
    """The run with the angle that slipped taken out of its wheels."""
    left, right = run.left_rad, run.right_rad
    for slip in slips:
        angle = left if slip.side == "left" else right
        inside = np.clip(run.time_s, slip.start_s, slip.end_s)
        corrected = angle - slip.ratio * (
            np.interp(inside, run.time_s, angle) - np.interp(slip.start_s, run.time_s, angle)
        )
        left, right = (corrected, right) if slip.side == "left" else (left, corrected)
    return replace(run, left_rad=left, right_rad=right)


@final
@dataclass(frozen=True)
class _Lost:
    """Of windows that begin at each row: travel that both wheels lost, and that they made; shape (2, windows)."""

    start_s: FloatArray
    lost: FloatArray
    made: FloatArray


def _lost(run: RobotRun, geometry: Geometry, angles: tuple[FloatArray, FloatArray], length_s: float) -> _Lost:
    """What the wheels turned, less what the pose says that they rolled, in every window."""
    begin = np.flatnonzero(run.time_s <= run.time_s[-1] - length_s)
    end = np.minimum(np.searchsorted(run.time_s, run.time_s[begin] + length_s), run.time_s.size - 1)
    return _Lost(run.time_s[begin], *_between(run, geometry, angles, begin, end))


def _between(
    run: RobotRun,
    geometry: Geometry,
    angles: tuple[FloatArray, FloatArray],
    begin: IntArray,
    end: IntArray,
) -> tuple[FloatArray, FloatArray]:
    heading = run.pose.heading_rad - np.radians(geometry.heading_offset_deg)
    lever = geometry.offset_forward_m + 1j * geometry.offset_left_m
    place = run.pose.x_m + 1j * run.pose.y_m - lever * np.exp(1j * heading)
    turn = heading[end] - heading[begin]
    chord = (place[end] - place[begin]) * np.exp(-0.5j * (heading[end] + heading[begin]))
    travel = chord.real / np.maximum(np.sinc(turn / (2.0 * np.pi)), 0.3)
    rolled = np.array([travel - 0.5 * geometry.track_m * turn, travel + 0.5 * geometry.track_m * turn])
    radii = np.array([[geometry.left_wheel_radius_m], [geometry.right_wheel_radius_m]])
    turned = radii * np.array([angle[end] - angle[begin] for angle in angles])
    return turned - rolled, turned


def _of_wheel(
    index: int,
    run: RobotRun,
    geometry: Geometry,
    angles: tuple[FloatArray, FloatArray],
    lost: _Lost,
    wheel: int,
    side: str,
    scale: float,
) -> list[SlipSpell]:
    if lost.start_s.size == 0:
        return []
    way = np.sign(lost.made[wheel])
    gone = lost.lost[wheel] * way
    suspect = (
        (gone > _SIGMAS * scale) & (gone > _LEAST_RATIO * np.abs(lost.made[wheel])) & (gone > _LEAST_LOST_M)
    )
    found = []
    for first, last in _stretches(suspect):
        span = _sharpened(run, geometry, angles, wheel, lost.start_s[first], lost.start_s[last] + _WINDOW_S)
        slip = _measured(index, run, geometry, angles, wheel, side, span, scale)
        if slip is not None:
            found.append(slip)
    return found


def _stretches(flags: BoolArray) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(np.int8), [0]])))
    return [(int(first), int(last) - 1) for first, last in edges.reshape(-1, 2)]


def _sharpened(
    run: RobotRun,
    geometry: Geometry,
    angles: tuple[FloatArray, FloatArray],
    wheel: int,
    begin_s: float,
    end_s: float,
) -> tuple[float, float]:
    """Where, within a stretch, windows of a fine length lose at least half of what the most losing one does."""
    fine = _lost(run, geometry, angles, _FINE_S)
    inside = (fine.start_s >= begin_s - _FINE_S) & (fine.start_s <= end_s)
    gone = np.where(inside, fine.lost[wheel] * np.sign(fine.made[wheel]), 0.0)
    strong = np.flatnonzero(gone > 0.5 * gone.max(initial=0.0))
    if strong.size == 0:
        return begin_s, end_s
    return float(fine.start_s[strong[0]] + 0.5 * _FINE_S), float(fine.start_s[strong[-1]] + 0.5 * _FINE_S)


def _measured(
    index: int,
    run: RobotRun,
    geometry: Geometry,
    angles: tuple[FloatArray, FloatArray],
    wheel: int,
    side: str,
    span: tuple[float, float],
    scale: float,
) -> SlipSpell | None:
    """The spell with its ratio; None where the pose catches up once the wheel turns as before, as after a lag."""
    ends = _alike(run, angles[wheel], span)
    if ends is None:
        return None
    rows = np.searchsorted(run.time_s, [span[0] - 0.2, span[1] + 0.2])
    near_begin, near_end = np.clip(rows, 0, run.time_s.size - 1)
    near, far = (
        float(_between(run, geometry, angles, np.array([a]), np.array([b]))[0][wheel, 0])
        for a, b in ((near_begin, near_end), ends)
    )
    angle = angles[wheel]
    radius = geometry.left_wheel_radius_m if wheel == 0 else geometry.right_wheel_radius_m
    made = radius * float(np.interp(span[1], run.time_s, angle) - np.interp(span[0], run.time_s, angle))
    if abs(made) < _LEAST_LOST_M or far * made <= 0.0 or abs(far) < _KEPT * abs(near):
        return None
    ratio, strength = far / made, abs(far) / scale
    if strength < _SIGMAS or ratio < _LEAST_RATIO:
        return None
    name: Side = "left" if side == "left" else "right"
    return SlipSpell(index, run.name, name, *span, min(ratio, 1.0), scale * 1.4 / abs(made), strength)


def _alike(run: RobotRun, angle: FloatArray, span: tuple[float, float]) -> tuple[int, int] | None:
    """A row before and a row after the spell at which the wheel turns alike, so that a lag cancels; None without."""
    time_s = run.time_s
    step = np.interp(time_s + 0.1, time_s, angle) - np.interp(time_s - 0.1, time_s, angle)
    before = np.flatnonzero((time_s < span[0] - 0.3) & (time_s > span[0] - _REACH_S))
    after = np.flatnonzero((time_s > span[1] + 0.3) & (time_s < span[1] + _REACH_S))
    if before.size == 0 or after.size == 0:
        return None
    differs = np.abs(step[before][:, None] - step[after][None, :])
    fastest = float(np.max(np.abs(step)))
    farther = (span[0] - time_s[before])[:, None] + (time_s[after] - span[1])[None, :]
    cost = differs / max(fastest, 1e-9) + 0.02 * farther
    place = np.unravel_index(int(np.argmin(cost)), cost.shape)
    if differs[place] > _ALIKE * fastest:
        return None
    return int(before[place[0]]), int(after[place[1]])
