"""One model of one motor as a Kalman filter: rows of a batch round its estimate, and what they make of time."""

from __future__ import annotations

import math
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.stages import STAGES
from nxt_twin.physics.terms import calls
from nxt_twin.twin.batch import CURRENT, Batch
from nxt_twin.twin.candidates import Candidate
from nxt_twin.twin.estimator import ComparedReading, Estimator
from nxt_twin.twin.rows import ANGLE, SHARED, put, stirred, taken

_LEAST_SPREAD = (1e-4, 1e-3, 1e-5, 1e-9)
"""Of the rows round the estimate, rad, rad/s, N·m and the number's unit, where it is surer than the arithmetic is
exact."""
_CLEARLY = 2.0
_WORTHWHILE = 0.1
"""A number differs by this number of its standard deviations, and by this share of what would be typical."""
_ANGLE_FLOOR = 0.01
_SPEED_FLOOR = 0.02
"""Standard deviations that angle (rad) and speed (rad/s) gain in a second at least: how a motor comes to rest within a
degree is not what a model is for."""


def place_matters(plant: Plant) -> bool:
    """Whether a motor at another angle would move otherwise: some of its terms ask for the angle."""
    stages = (stage for stage in STAGES if stage != "reading")
    return any(
        "angle" in call.arguments and call.effect.id in plant.active
        for stage in stages
        for call in calls(plant.layout, stage)
    )


@final
class Strand:
    """A Kalman filter for angle, speed, unknown torque and, of a candidate, its number.

    The rows of the batch are the estimate and its neighbours, one standard deviation away in each direction
    of each component. Central differences between the moved rows give the filter's transition. So a motor
    that sticks, or is about to break away, is seen as such. Where nothing depends on the angle itself, a
    neighbour at another angle would move exactly alike, and is left out.

    Args:
        candidate: the plant, and what is in doubt.
        first_row: of its rows in the batch.
        torque_std: of the unknown torque, N·m.
        torque_time_s: how long that lasts.
    """

    def __init__(self, candidate: Candidate, first_row: int, torque_std: float, torque_time_s: float) -> None:
        self.candidate = candidate
        self.size = SHARED + (candidate.slot is not None)
        self._along = np.array([i for i in range(self.size) if i != ANGLE or place_matters(candidate.plant)])
        self.rows = slice(first_row, first_row + 2 * self._along.size + 1)
        self._torque_std = torque_std
        self._torque_time_s = torque_time_s
        number = [] if candidate.slot is None else [candidate.value]
        variances = [1.0, 1.0, torque_std**2, *([candidate.std**2] if number else [])]
        self.estimator = Estimator(np.array([0.0, 0.0, 0.0, *number]), np.array(variances))
        self._column = 0 if candidate.slot is None else candidate.plant.layout.index[candidate.slot]
        self._least_spread = np.array(_LEAST_SPREAD[: self.size])
        self._spread = np.zeros(self.size)
        self._transition = np.zeros((self.size, self.size))
        self._process = np.zeros((self.size, self.size))

    @property
    def mean(self) -> FloatArray:
        """Angle (rad), speed (rad/s), torque (N·m), and the number in doubt."""
        return self.estimator.mean

    @property
    def differs(self) -> bool:
        """Whether the number in doubt is clearly not what the model has."""
        off = abs(float(self.mean[SHARED]) - self.candidate.absent)
        std = math.sqrt(max(float(self.estimator.covariance[SHARED, SHARED]), 0.0))
        return off > max(_CLEARLY * std, _WORTHWHILE * self.candidate.std)

    def place(self, batch: Batch, angle: float, speed: float, variances: tuple[float, float]) -> None:
        """Set the motion anew, in a state otherwise at rest; the number in doubt is kept."""
        mean, covariance = self.mean.copy(), self.estimator.covariance.copy()
        mean[:SHARED] = angle, speed, 0.0
        covariance[:SHARED, :] = 0.0
        covariance[:, :SHARED] = 0.0
        covariance[range(SHARED), range(SHARED)] = (*variances, self._torque_std**2)
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
            np.array([mean[0], mean[1], 0.0, *self.mean[SHARED:]]),
            np.diag([covariance[0, 0], covariance[1, 1], self._torque_std**2, *self._own_variance()]),
        )
        batch.state[self.rows] = batch.state[other.rows.start]
        self.sow(batch)

    def _own_variance(self) -> list[float]:
        return list(np.diag(self.estimator.covariance)[SHARED:])

    def sow(self, batch: Batch) -> None:
        """Put the rows round the estimate, with all states that are not estimated as in the first row."""
        rows = self.rows
        put(
            self.mean,
            self.estimator.covariance,
            self._least_spread,
            self.candidate.least,
            self._along,
            self._spread,
            batch.state[rows],
            batch.torque[rows],
            batch.values[rows, self._column],
        )
        if self.candidate.name == "constant_load":
            batch.set_own_load(rows)

    def reap(self, batch: Batch, since_s: float, jerked: FloatArray | None = None) -> None:
        """Make the filter's prediction out of where the rows have got to in `since_s`.

        Args:
            batch: with the rows.
            since_s: since they were sown.
            jerked: covariance of angle and speed by commands whose moments were not known well, shape (2, 2).
        """
        moved, transition, process = self.mean.copy(), self._transition, self._process
        taken(self._along, self._spread, batch.state[self.rows], batch.torque[self.rows], moved, transition)
        fresh = self._torque_std**2 * (1.0 - math.exp(-2.0 * since_s / self._torque_time_s))
        stirred(transition, fresh, _ANGLE_FLOOR**2 * since_s, _SPEED_FLOOR**2 * since_s, process)
        if jerked is not None:
            process[:2, :2] += jerked
        self.estimator.predict(moved, transition, process)

    def compare(self, reading: float, variance: float) -> ComparedReading:
        """The innovation of a reading (rad) under this model."""
        return self.estimator.compare(reading, variance)

    def update(self, reading: float, variance: float) -> ComparedReading:
        """Believe a reading."""
        return self.estimator.update(reading, variance)
