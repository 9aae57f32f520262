"""The input of a kernel: the commands in force and the readings to predict, in SI units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.recording.recording import InputKind

VOLTAGES: Final[tuple[InputKind, ...]] = ("power_pct", "voltage_v", "goal_position_rad")
"""Inputs that set a voltage, under which a motor's motion tells nothing of the size of its torques."""

_OF_ANY_AGE = (-1.0, -1.0, 0.0, 0.0)
_BESIDE_S: Final = 0.02  # to either side of a reading, over which the others tell the speed


_FEWEST_ROWS = 3  # between which polls may differ


@final
@dataclass(frozen=True)
class Signals:
    """What drives a plant and what was read from it.

    Attributes:
        name: the recording's name.
        channel: the column that was read.
        input_kind: what the command is.
        command_time_s: stamps from which commands hold, shape (commands,).
        command: duty -1…1, V, A, N·m or N by `input_kind`, shape (commands,).
        command_mode: drive mode, shape (commands,).
        command_supply_v: open-circuit supply, NaN where it was never read, shape (commands,).
        time_s: stamps of the readings, shape (samples,).
        measured: readings in rad or m, or per second; NaN where a row has none, shape (samples,).
        is_speed: the readings are speeds.
        quantum: smallest step of the readings, 0 if none is known.
        session_s: when the recording began, counted from the beginning of the first one of its session.
        lag_s: by which speed lags behind the commands in the plant as given, s; 0 where it tells of none.
        sets_in_s: when something sets in that does so anew in each recording, s of the session; NaN where nothing does.
        clock_s: how far on a clock that wanders is as the recording begins, s, where that is the recording's own.
        held_s: when stamps stood still while rows went on, s after the first one, and for how long, shape (moments, 2).
        ages: of held readings, for how long each has been shown, and how long before that nobody looked, s. The latter
            is negative where nothing tells. Then by how much each stamp is later than its neighbours tell, and
            `late_open`, both as shares of `late_span_s`. Shape (samples, 4).
        refreshed_s: the time from one refreshment of held readings to the next, 0 where nothing tells it.
        late_span_s: the span of what stamps are late by, row by row; 0 where they follow a smooth course.
        late_open: how far each row's lateness is open, a standard deviation, as a share of `late_span_s`.
        command_late: as the third of `ages`, of the commands' stamps, shape (commands,).
        command_polls: how much longer than their mean the polls after and before a command's row are, s. Shape
            (commands, 2); 0 where it came with no row.
        clump_rows: how many rows came at once on average, and are spread over the time in which they were read; 0 where
            each came by itself.
        rounded_s: the step to which stamps were rounded, where rows are put on an even course for it; else 0.
        open_s: how far the moment of each reading is open, a standard deviation, s, shape (samples,); 0 where rows came
            one by one, with fine stamps.
        command_open_s: as `open_s`, of the commands that came with rows in clumps, shape (commands,).
        others_time_s: stamps from which the brick's other motors load the supply anew, empty where none is driven.
        others_load: how they do: shares and duty·speed (rad/s) as `others.with_others` has them, shape (stamps, 2).
    """

    name: str
    channel: str
    input_kind: InputKind
    command_time_s: FloatArray
    command: FloatArray
    command_mode: IntArray
    command_supply_v: FloatArray
    time_s: FloatArray
    measured: FloatArray
    is_speed: bool
    quantum: float
    session_s: float = 0.0
    lag_s: float = 0.0
    sets_in_s: float = np.nan
    clock_s: float = 0.0
    held_s: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    ages: FloatArray = field(default_factory=lambda: np.zeros((0, 4)))
    refreshed_s: float = 0.0
    late_span_s: float = 0.0
    late_open: float = 0.0
    command_late: FloatArray = field(default_factory=lambda: np.zeros(0))
    command_polls: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    clump_rows: float = 0.0
    rounded_s: float = 0.0
    open_s: FloatArray = field(default_factory=lambda: np.zeros(0))
    command_open_s: FloatArray = field(default_factory=lambda: np.zeros(0))
    others_time_s: FloatArray = field(default_factory=lambda: np.zeros(0))
    others_load: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))

    def __post_init__(self) -> None:
        if len(self.ages) != self.time_s.size:
            object.__setattr__(self, "ages", np.tile(_OF_ANY_AGE, (self.time_s.size, 1)))
        if self.open_s.size != self.time_s.size:
            object.__setattr__(self, "open_s", np.zeros(self.time_s.size))
        if self.command_open_s.size != self.command_time_s.size:
            object.__setattr__(self, "command_open_s", np.zeros(self.command_time_s.size))
        if self.command_late.size != self.command_time_s.size:
            object.__setattr__(self, "command_late", np.zeros(self.command_time_s.size))
        if len(self.command_polls) != self.command_time_s.size:
            object.__setattr__(self, "command_polls", _polls(self.time_s, self.command_time_s))

    @cached_property
    def interval_s(self) -> float:
        """The median time from one reading to the next, s."""
        return float(np.median(np.diff(self.time_s[np.isfinite(self.measured)])))

    @cached_property
    def command_moments(self) -> FloatArray:
        """`command_late` and `command_polls` side by side, shape (commands, 3)."""
        return np.column_stack([self.command_late, self.command_polls])

    @cached_property
    def strays(self) -> FloatArray:
        """How far a reading strays as its moment is open, a standard deviation, SI, shape (samples,).

        The readings beside it tell the speed, so that a plant which runs away makes no reading doubtful.
        """
        found = np.zeros(self.time_s.size)
        rows = np.flatnonzero(np.isfinite(self.measured))
        if self.is_speed or rows.size < 2 or not self.open_s.any():
            return found
        beside = max(1, round(_BESIDE_S / self.interval_s))
        before = rows[np.maximum(np.arange(rows.size) - beside, 0)]
        after = rows[np.minimum(np.arange(rows.size) + beside, rows.size - 1)]
        speed = (self.measured[after] - self.measured[before]) / (self.time_s[after] - self.time_s[before])
        found[rows] = self.open_s[rows] * np.abs(speed)
        return found

    def part(self, rows: IntArray) -> Signals:
        """The same commands with only some of the readings."""
        return replace(
            self,
            time_s=self.time_s[rows],
            measured=self.measured[rows],
            ages=self.ages[rows],
            open_s=self.open_s[rows],
        )

    def of_any_age(self) -> Signals:
        """The same readings, with nothing known of their ages."""
        return replace(
            self,
            ages=np.zeros((0, 4)),
            refreshed_s=0.0,
            late_span_s=0.0,
            late_open=0.0,
            command_late=np.zeros(0),
        )

    def of_known_moments(self) -> Signals:
        """The same, as if stamps told exactly when each row was read."""
        known = self.ages * np.array([1.0, 1.0, 1.0, 0.0])
        return replace(self, ages=known, open_s=np.zeros(0), command_open_s=np.zeros(0))

    def alone(self) -> Signals:
        """The same with the brick's other motors at rest."""
        return replace(self, others_time_s=np.zeros(0), others_load=np.zeros((0, 2)))

    def command_at_samples(self) -> FloatArray:
        """The command in force just before each reading, shape (samples,)."""
        before = np.searchsorted(self.command_time_s, self.time_s, side="left") - 1
        held: FloatArray = np.where(before >= 0, self.command[np.maximum(before, 0)], 0.0)
        return held


def _polls(time_s: FloatArray, command_time_s: FloatArray) -> FloatArray:
    """`Signals.command_polls` of commands that came with rows at `time_s`."""
    if time_s.size < _FEWEST_ROWS or not command_time_s.size:
        return np.zeros((command_time_s.size, 2))
    length_s = np.concatenate([[np.nan], np.diff(time_s), [np.nan]])
    row = np.minimum(np.searchsorted(time_s, command_time_s), time_s.size - 1)
    found = np.column_stack([length_s[row + 1], length_s[row]])
    found[time_s[row] != command_time_s] = np.nan
    known = np.isfinite(found)
    mean_s = np.sum(np.where(known, found, 0.0), axis=0) / np.maximum(known.sum(axis=0), 1)
    return np.where(known, found - mean_s, 0.0)


def in_session(recordings: Sequence[Signals]) -> list[Signals]:
    """The same recordings as one session, end to end in their order."""
    length_s = [float(signals.time_s[-1] - signals.time_s[0]) for signals in recordings]
    began_s = np.concatenate([[0.0], np.cumsum(length_s)])
    return [replace(signals, session_s=float(at)) for signals, at in zip(recordings, began_s, strict=False)]
