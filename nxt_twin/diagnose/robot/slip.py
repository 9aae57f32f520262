"""Spells in which a wheel turned without travel: located, and taken out of the wheels' angles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.robot.effects import WheelSide
from nxt_twin.diagnose.robot.rolled import body_motion
from nxt_twin.diagnose.robot.runs import RobotRun
from nxt_twin.physics.robot.drive import Geometry
from nxt_twin.physics.robot.odometry import PosePath

_WINDOW_S: Final = 1.0  # length of the windows in which slip is looked for
_FINE_S: Final = 0.4  # length of the windows that sharpen where a spell begins and ends
_SIGMAS: Final = 7.0  # standard deviations of a second's lost travel that a spell's loss has to exceed
_LEAST_RATIO: Final = 0.06  # share of its travel that a slipping wheel loses, at least
_MOST_RATIO: Final = 1.2
"""A wheel loses at most all that it turned, errors of measurement apart."""
_LEAST_LOST_M: Final = 2e-3  # least travel that a window of slip loses, and that a wheel turns in a spell
_KEPT: Final = 0.6
"""Share of a spell's loss that remains once the wheel turns as before; what a lag displaces comes back.

Where a spell holds a smaller share of the loss between those moments, travel is lost all along.
"""
_MARGIN_S: Final = 0.2  # before and after a spell that is counted with it
_ONE_WAY: Final = 0.4
"""Of a spell's travel, what has to be left after turning back: about a reversal, a lag looks like slip."""
_REACH_S: Final = 4.0  # before and after a spell in which moments of like turning are looked for
_ALIKE: Final = 0.15  # share of the fastest turning by which two moments of like turning may differ
_MAD: Final = 1.4826  # standard deviation of normal values over their median absolute deviation
SIDES: Final = (0, 1)
_PART: Final = " (part "
_LEAST_PART_S: Final = 1.5  # length of a part between spells, at or below which it is left out
_NAMES: Final[tuple[WheelSide, WheelSide]] = ("left", "right")


@final
@dataclass(frozen=True)
class SlipSpell:
    """One spell of one wheel.

    Attributes:
        run: index of the run.
        recording: its name.
        side: which wheel.
        start_s, end_s: on the recording's clock.
        ratio: of the wheel's travel that was lost, with its standard deviation.
        strength: of the lost travel, in standard deviations.
        lost: moments and the angle (rad) that was lost since the first of them, where the course of it is known.
    """

    run: int
    recording: str
    side: WheelSide
    start_s: float
    end_s: float
    ratio: float
    std: float
    strength: float
    lost: tuple[FloatArray, FloatArray] | None = None


def find_slip(
    runs: Sequence[RobotRun], geometry: Geometry, wheels_rad: Sequence[tuple[FloatArray, FloatArray]]
) -> tuple[SlipSpell, ...]:
    """Spells in which wheels turned without travel.

    Args:
        runs: the recordings.
        geometry: the fitted robot.
        wheels_rad: angles of each run's wheels when its poses were taken.
    """
    wheels = [
        travel_of(index, run, geometry, angles, side)
        for index, (run, angles) in enumerate(zip(runs, wheels_rad, strict=True))
        for side in SIDES
    ]
    scaled = [replace(wheel, scale=_spread(wheels[number % 2 :: 2])) for number, wheel in enumerate(wheels)]
    found = [slip for wheel in scaled for slip in _of_wheel(wheel)]
    return tuple(sorted(found, key=lambda slip: -slip.strength))


def _spread(wheels: Sequence[WheelTravel]) -> float:
    """The standard deviation of travel that one side's wheels lose in a second, m."""
    pooled = np.concatenate([wheel.over(wheel.lost_m, _WINDOW_S)[1] for wheel in wheels])
    spread = _MAD * float(np.median(np.abs(pooled - np.median(pooled)))) if pooled.size else 0.0
    return max(spread, 1e-4)


def without_slip(run: RobotRun, slips: Sequence[SlipSpell]) -> RobotRun:
    """The run with the angle that slipped taken out of its wheels."""
    left, right = run.left_rad, run.right_rad
    for slip in slips:
        angle = left if slip.side == "left" else right
        corrected = angle - _slipped(slip, run.time_s, angle)
        left, right = (corrected, right) if slip.side == "left" else (left, corrected)
    return replace(run, left_rad=left, right_rad=right)


def gripping(run: RobotRun, slips: Sequence[SlipSpell]) -> list[RobotRun]:
    """The parts of a run between located spells of slip, but for short ones; the whole where none is long enough.

    Args:
        run: a whole recording.
        slips: of any recordings, or of parts of them.
    """
    kept = np.ones(run.time_s.size, dtype=bool)
    for slip in slips:
        if slip.lost is None and slip.recording.split(_PART)[0] == run.name:
            kept &= (run.time_s < slip.start_s - _MARGIN_S) | (run.time_s > slip.end_s + _MARGIN_S)
    if kept.all():
        return [run]
    rows = [slice(first, last + 1) for first, last in stretches(kept)]
    return [_part(run, each) for each in rows if np.ptp(run.time_s[each]) > _LEAST_PART_S] or [run]


def _part(run: RobotRun, rows: slice) -> RobotRun:
    pose = PosePath(run.pose.x_m[rows], run.pose.y_m[rows], run.pose.heading_rad[rows])
    left, right = run.left_rad[rows], run.right_rad[rows]
    return replace(run, time_s=run.time_s[rows], left_rad=left, right_rad=right, pose=pose)


def _slipped(slip: SlipSpell, time_s: FloatArray, angle: FloatArray) -> FloatArray:
    """The angle that was lost until each row, rad."""
    if slip.lost is not None:
        return np.interp(time_s, *slip.lost)
    inside = np.clip(time_s, slip.start_s, slip.end_s)
    return slip.ratio * (np.interp(inside, time_s, angle) - np.interp(slip.start_s, time_s, angle))


@final
@dataclass(frozen=True)
class WheelTravel:
    """One wheel of one run.

    Attributes:
        run: index and name of the run, and the wheel's side.
        time_s: shape (rows,).
        angle_rad: of the wheel.
        turned_m: the travel that its turning stands for.
        lost_m: that travel less what the pose says that the wheel rolled.
        scale: standard deviation of what is lost in a second, m.
    """

    run: tuple[int, str, WheelSide]
    time_s: FloatArray
    angle_rad: FloatArray
    turned_m: FloatArray
    lost_m: FloatArray
    scale: float = 1e-4

    @property
    def path_m(self) -> FloatArray:
        """The travel, whichever way the wheel turns, summed from row to row."""
        return np.concatenate([[0.0], np.cumsum(np.abs(np.diff(self.turned_m)))])

    def over(self, values: FloatArray, length_s: float) -> tuple[FloatArray, FloatArray]:
        """Where windows of a length begin, and what `values` gain in each."""
        begin = np.flatnonzero(self.time_s <= self.time_s[-1] - length_s)
        end = np.minimum(np.searchsorted(self.time_s, self.time_s[begin] + length_s), self.time_s.size - 1)
        return self.time_s[begin], values[end] - values[begin]

    def between(self, values: FloatArray, begin_s: float, end_s: float) -> float:
        """What `values` gain from one moment to another."""
        begin, end = np.interp([begin_s, end_s], self.time_s, values)
        return float(end - begin)


def travel_of(
    index: int, run: RobotRun, geometry: Geometry, angles: tuple[FloatArray, FloatArray], side: int
) -> WheelTravel:
    """A wheel's turning beside its rolling, by a run's poses; `angles` (rad) at their rows, side 0 is the left."""
    motion = body_motion(run.pose, geometry)
    radius = geometry.left_wheel_radius_m if side == 0 else geometry.right_wheel_radius_m
    rolled = motion.wheel_m(side, geometry.track_m)
    turned = radius * angles[side]
    return WheelTravel((index, run.name, _NAMES[side]), run.time_s, angles[side], turned, turned - rolled)


def _of_wheel(wheel: WheelTravel) -> list[SlipSpell]:
    start_s, gone = wheel.over(wheel.lost_m, _WINDOW_S)
    if start_s.size == 0:
        return []
    _, made = wheel.over(wheel.turned_m, _WINDOW_S)
    _, path = wheel.over(wheel.path_m, _WINDOW_S)  # where the wheel turns back, a lag looks like a loss
    gone = gone * np.sign(made)
    suspect = (gone > _SIGMAS * wheel.scale) & (gone > _LEAST_RATIO * path) & (gone > _LEAST_LOST_M)
    found = []
    for first, last in stretches(suspect):
        slip = _measured(wheel, _sharpened(wheel, float(start_s[first]), float(start_s[last]) + _WINDOW_S))
        if slip is not None:
            found.append(slip)
    return _apart(found)


def _apart(found: Sequence[SlipSpell]) -> list[SlipSpell]:
    """Of spells that overlap, the strongest: two stretches may sharpen to one spell, which counts once."""
    kept: list[SlipSpell] = []
    for slip in sorted(found, key=lambda each: -each.strength):
        if all(slip.end_s <= one.start_s or slip.start_s >= one.end_s for one in kept):
            kept.append(slip)
    return kept


def stretches(flags: BoolArray) -> list[tuple[int, int]]:
    """First and last row of each stretch in which flags are set."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(np.int8), [0]])))
    return [(int(first), int(last) - 1) for first, last in edges.reshape(-1, 2)]


def _sharpened(wheel: WheelTravel, begin_s: float, end_s: float) -> tuple[float, float]:
    """Where, within a stretch, windows of a fine length lose at least half of what the most losing one does."""
    start_s, gone = wheel.over(wheel.lost_m, _FINE_S)
    _, made = wheel.over(wheel.turned_m, _FINE_S)
    inside = (start_s >= begin_s - _FINE_S) & (start_s <= end_s)
    gone = np.where(inside, gone * np.sign(made), 0.0)
    strong = np.flatnonzero(gone > 0.5 * gone.max(initial=0.0))
    if strong.size == 0:
        return begin_s, end_s
    return float(start_s[strong[0]] + 0.5 * _FINE_S), float(start_s[strong[-1]] + 0.5 * _FINE_S)


def _measured(wheel: WheelTravel, span: tuple[float, float]) -> SlipSpell | None:
    """The spell with its ratio; None where the pose catches up once the wheel turns as before, as after a lag."""
    ends = _alike(wheel.time_s, wheel.angle_rad, span)
    if ends is None:
        return None
    wider = (span[0] - _MARGIN_S, span[1] + _MARGIN_S)
    near, far = (wheel.between(wheel.lost_m, *each) for each in (wider, ends))
    if far * near <= 0.0 or abs(far) < _KEPT * abs(near):
        return None
    if abs(wheel.between(wheel.turned_m, *wider)) < _ONE_WAY * wheel.between(wheel.path_m, *wider):
        return None
    # Where travel is lost all along, as tyres scrub in a long turn, only the spell's own part counts for it.
    spread = abs(near) < _KEPT * abs(far)
    lost, made = (
        (near, wheel.between(wheel.turned_m, *wider))
        if spread
        else (far, wheel.between(wheel.turned_m, *span))
    )
    if abs(made) < _LEAST_LOST_M:
        return None
    ratio, strength = lost / made, abs(lost) / wheel.scale
    if strength < _SIGMAS or not _LEAST_RATIO <= ratio <= _MOST_RATIO:
        return None
    return SlipSpell(*wheel.run, *span, min(ratio, 1.0), wheel.scale * 1.4 / abs(made), strength)


def _alike(time_s: FloatArray, angle: FloatArray, span: tuple[float, float]) -> tuple[float, float] | None:
    """Moments before and after the spell at which the wheel turns alike, so that a lag cancels; None without."""
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
    return float(time_s[before[place[0]]]), float(time_s[after[place[1]]])
