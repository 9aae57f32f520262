"""One model of one motor as a Kalman filter: rows of a batch round its estimate, and what they make of time."""

from __future__ import annotations

import math
from typing import final

import numpy as np

from nxt_twin.recording.recording import FloatArray
from nxt_twin.twin.batch import ANGLE, CURRENT, SPEED, Batch
from nxt_twin.twin.candidates import Candidate
from nxt_twin.twin.estimator import Compared, Estimator
from nxt_twin.twin.jerk import Jerk

_TORQUE = 2
_SHARED = 3
_LEAST_SPREAD = (1e-4, 1e-3, 1e-5)
"""Of the rows round the estimate, rad, rad/s and N·m, where it is surer than the arithmetic is exact."""
_CLEARLY = 3.0
_WORTHWHILE = 0.1
"""A number differs by so many of its standard deviations, and by so much of what would be typical."""
_ANGLE_FLOOR = 0.01
_SPEED_FLOOR = 0.02
"""Standard deviations that angle (rad) and speed (rad/s) gain in a second at least: how a motor comes to rest within a
degree is not what a model is for."""
_WHITE = np.array([[1 / 5, 1 / 4, 1 / 3], [1 / 4, 1 / 3, 1 / 2], [1 / 3, 1 / 2, 1.0]])
"""What torque that arrives evenly over an interval does to angle, speed and torque, as shares of what it does when
it is there from the beginning."""


@final
class Strand:
    """A Kalman filter for angle, speed, unknown torque and, of a candidate, its number.

    The rows of the batch are the estimate itself and, each way along each component, a neighbour one standard
    deviation away; central differences between them, after they have moved, are the filter's transition. So a
    motor that sticks, or is about to break away, is seen as such.

    Args:
        candidate: the plant, and what is in doubt.
        first_row: of its rows in the batch.
        torque_std: of the unknown torque, N·m.
        torque_time_s: how long that lasts.
    """

    def __init__(self, candidate: Candidate, first_row: int, torque_std: float, torque_time_s: float) -> None:
        self.candidate = candidate
        self.size = _SHARED + (candidate.slot is not None)
        self.rows = slice(first_row, first_row + 2 * self.size + 1)
        self._torque_std = torque_std
        self._torque_time_s = torque_time_s
        number = [] if candidate.slot is None else [candidate.value]
        variances = [1.0, 1.0, torque_std**2, *([candidate.std**2] if number else [])]
        self.estimator = Estimator(np.array([0.0, 0.0, 0.0, *number]), np.array(variances))
        self._column = None if candidate.slot is None else candidate.plant.layout.index[candidate.slot]
        self._spread = np.zeros(self.size)
        self._jerks: list[Jerk] = []
        self._offsets = np.concatenate([np.zeros((1, self.size)), np.eye(self.size), -np.eye(self.size)])

    @property
    def mean(self) -> FloatArray:
        """Angle (rad), speed (rad/s), torque (N·m), and the number in doubt."""
        return self.estimator.mean

    @property
    def differs(self) -> bool:
        """Whether the number in doubt is clearly not what the model has."""
        off = abs(float(self.mean[_SHARED]) - self.candidate.absent)
        std = math.sqrt(max(float(self.estimator.covariance[_SHARED, _SHARED]), 0.0))
        return off > max(_CLEARLY * std, _WORTHWHILE * self.candidate.std)

    def place(self, batch: Batch, angle: float, speed: float, variances: tuple[float, float]) -> None:
        """Set the motion anew, in a state otherwise at rest; the number in doubt is kept."""
        mean, covariance = self.mean.copy(), self.estimator.covariance.copy()
        mean[:_SHARED] = angle, speed, 0.0
        covariance[:_SHARED, :] = 0.0
        covariance[:, :_SHARED] = 0.0
        covariance[range(_SHARED), range(_SHARED)] = (*variances, self._torque_std**2)
        self.estimator.set(mean, covariance)
        batch.state[self.rows] = 0.0
        self._set_moving(batch, speed)
        self.sow(batch)

    def _set_moving(self, batch: Batch, speed: float) -> None:
        """Speeds among the effects' states go with the plant's own."""
        column = CURRENT + 1
        for effect in self.candidate.plant.layout.effects:
            for state in effect.states:
                if state in effect.moving:
                    batch.state[self.rows, column] = speed
                column += 1

    def follow(self, other: Strand, batch: Batch) -> None:
        """Take over the motion of another strand, and how sure it is; the unknown torque begins anew."""
        mean, covariance = other.mean, other.estimator.covariance
        self.estimator.set(
            np.array([mean[0], mean[1], 0.0, *self.mean[_SHARED:]]),
            np.diag([covariance[0, 0], covariance[1, 1], self._torque_std**2, *self._own_variance()]),
        )
        batch.state[self.rows] = batch.state[other.rows.start]
        self.sow(batch)

    def _own_variance(self) -> list[float]:
        return list(np.diag(self.estimator.covariance)[_SHARED:])

    def sow(self, batch: Batch) -> None:
        """Put the rows round the estimate, with all states that are not estimated as in the first row."""
        mean = self.mean
        std = np.sqrt(np.maximum(np.diag(self.estimator.covariance), 0.0))
        self._spread[:_SHARED] = np.maximum(std[:_SHARED], _LEAST_SPREAD)
        self._spread[_SHARED:] = np.maximum(std[_SHARED:], 1e-9)
        points = mean + self._offsets * self._spread
        batch.state[self.rows] = batch.state[self.rows.start]
        batch.state[self.rows, ANGLE] = points[:, ANGLE]
        batch.state[self.rows, SPEED] = points[:, SPEED]
        batch.torque[self.rows] = points[:, _TORQUE]
        if self._column is not None:
            numbers = np.maximum(points[:, _SHARED], self.candidate.least)
            batch.values[self.rows, self._column] = numbers
            if self.candidate.name == "constant_load":
                batch.set_own_load(self.rows)

    def expect(self, jerk: Jerk) -> None:
        """A command acts at a moment that is not known well."""
        self._jerks.append(jerk)

    def reap(self, batch: Batch, since_s: float) -> None:
        """Make the filter's prediction out of where the rows have got to in `since_s`."""
        rows = batch.state[self.rows]
        moved = np.column_stack([rows[:, ANGLE], rows[:, SPEED], batch.torque[self.rows]])
        if self.size > _SHARED:
            numbers = self.mean[_SHARED] + self._offsets[:, _SHARED] * self._spread[_SHARED]
            moved = np.column_stack([moved, numbers])
        size = self.size
        transition = (moved[1 : size + 1] - moved[size + 1 :]).T / (2.0 * self._spread)
        process = self._process(transition, since_s)
        for jerk in [jerk for jerk in self._jerks if jerk.at_s <= batch.now_s]:
            self._jerks.remove(jerk)
            process[:2, :2] += jerk.spread(batch.now_s - jerk.at_s)
        self.estimator.predict(moved[0], transition, process)

    def _process(self, transition: FloatArray, since_s: float) -> FloatArray:
        process = np.zeros((self.size, self.size))
        forgotten = math.exp(-since_s / self._torque_time_s)
        reach = transition[:_SHARED, _TORQUE].copy()
        reach[_TORQUE] = 1.0
        fresh = self._torque_std**2 * (1.0 - forgotten**2)
        process[:_SHARED, :_SHARED] = fresh * _WHITE * np.outer(reach, reach)
        process[ANGLE, ANGLE] += _ANGLE_FLOOR**2 * since_s
        process[SPEED, SPEED] += _SPEED_FLOOR**2 * since_s
        return process

    def compare(self, reading: float, variance: float) -> Compared:
        """What a reading (rad) says of this model."""
        return self.estimator.compare(reading, variance)

    def update(self, reading: float, variance: float) -> Compared:
        """Believe a reading."""
        return self.estimator.update(reading, variance)
