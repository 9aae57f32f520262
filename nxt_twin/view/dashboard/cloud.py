"""The unknown torque against speed as a picture in a plane: dots, their binned mean, and axes with figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.recording.columns import Port
from nxt_twin.twin.records import Tick
from nxt_twin.view.numbers import plain

_KEPT: Final = 1200
_BINS: Final = 16
_LEAST_IN_BIN: Final = 5
WIDTH: Final = 10.0
HEIGHT: Final = 6.0
"""Half the picture's size, in its own units; ordinates grow downward, as in an image."""


@final
@dataclass(frozen=True)
class CloudPicture:
    """The picture, in its own units.

    Attributes:
        dots: shape (dots, 2), oldest first.
        age: of each dot, 1 for the oldest and 0 for the newest.
        former: dots of the model before, shape (dots, 2).
        mean: the binned mean, shape (bins, 2).
        marks: places of the axes' figures, shape (4, 2).
        figures: the axes' figures, with units.
    """

    dots: FloatArray
    age: FloatArray
    former: FloatArray
    mean: FloatArray
    marks: FloatArray
    figures: tuple[str, ...]


@final
class Cloud:
    """The last speeds and unknown torques of a motor, thinned by halves when they become many."""

    def __init__(self, port: Port) -> None:
        self._port = port
        self._stride = 1
        self._seen = 0
        self._rows: list[tuple[float, float, float]] = []
        self._since_s = -np.inf

    def begin_anew(self, at_s: float) -> None:
        """From this moment on another model is in force; what is older is that of the models before."""
        self._since_s = at_s

    def add(self, ticks: Sequence[Tick]) -> None:
        """Take a batch of polls."""
        for tick in ticks:
            for motor in tick.motors:
                if motor.port != self._port:
                    continue
                if self._seen % self._stride == 0:
                    torque_mnm = 1e3 * motor.unknown_torque_nm
                    self._rows.append((tick.received_s, motor.speed_deg_per_s, torque_mnm))
                self._seen += 1
        if len(self._rows) > _KEPT:
            self._rows = self._rows[::2]
            self._stride *= 2

    def picture(self) -> CloudPicture | None:
        """The picture of what was taken so far; None before there is anything."""
        taken = np.array(self._rows, dtype=np.float64).reshape(-1, 3)
        taken = taken[np.all(np.isfinite(taken), axis=1)]
        if taken.shape[0] < _LEAST_IN_BIN:
            return None
        both, now = taken[:, 1:], taken[:, 0] >= self._since_s
        rows, former = both[now], both[~now]
        reach = np.array([_round_up(np.max(np.abs(both[:, axis]))) for axis in (0, 1)])
        scale = np.array([WIDTH, -HEIGHT]) / reach
        marks = np.array([[-WIDTH, 0.0], [WIDTH, 0.0], [0.0, -HEIGHT], [0.0, HEIGHT]])
        figures = (
            f"{plain(-reach[0])}",
            f"{plain(reach[0])} deg/s",
            f"{plain(reach[1])} mN·m",
            f"{plain(-reach[1])}",
        )
        age = np.linspace(1.0, 0.0, rows.shape[0])
        mean = _binned(rows) * scale if rows.shape[0] >= _LEAST_IN_BIN else np.zeros((0, 2))
        return CloudPicture(rows * scale, age, former * scale, mean, marks, figures)


def _binned(rows: FloatArray) -> FloatArray:
    low, high = np.min(rows[:, 0]), np.max(rows[:, 0])
    place = np.digitize(rows[:, 0], np.linspace(low, high, _BINS + 1)[1:-1])
    means = [
        np.mean(rows[place == number], axis=0)
        for number in range(_BINS)
        if np.count_nonzero(place == number) >= _LEAST_IN_BIN
    ]
    return np.array(means, dtype=np.float64).reshape(-1, 2)


def _round_up(value: float) -> float:
    """The next of 1, 2, 5, 10 … above `value`."""
    if value <= 0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= 0.999 * value))
