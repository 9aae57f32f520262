"""The battery: what it would give without load, from readings that show whatever the motors drew."""

from __future__ import annotations

import statistics
from collections import deque
from typing import final

_READINGS = 9


@final
class Supply:
    """An open-circuit voltage behind an internal resistance.

    Args:
        assumed_v: until the first reading.
        resistance_ohm: of battery and contacts; what all motors draw together passes through it.
    """

    def __init__(self, assumed_v: float, resistance_ohm: float) -> None:
        self._open_v = assumed_v
        self._resistance_ohm = resistance_ohm
        self._readings: deque[float] = deque(maxlen=_READINGS)

    @property
    def open_v(self) -> float:
        """The estimate of the voltage without load, V."""
        return self._open_v

    def under(self, drawn_a: float) -> float:
        """The voltage at the terminals while so much is drawn, V."""
        return max(self._open_v - self._resistance_ohm * max(drawn_a, 0.0), 0.0)

    def read(self, terminal_v: float, drawn_a: float) -> None:
        """Take a reading of the terminals; the median of the last few is believed."""
        self._readings.append(terminal_v + self._resistance_ohm * max(drawn_a, 0.0))
        self._open_v = statistics.median(self._readings)
