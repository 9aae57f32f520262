"""The battery: what it would give without load, from readings that show whatever the motors drew."""

from __future__ import annotations

import math
import statistics
from collections import deque
from typing import final

_READINGS = 9
_MEMORY_S = 30.0


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


@final
class Company:
    """How much all motors together draw while one of them draws so much: the slope of the one over the other.

    Whoever looks at that motor alone takes what the battery loses to the others for its own doing.
    """

    def __init__(self) -> None:
        self._own = 0.0
        self._along = 0.0
        self._last_s = 0.0

    @property
    def times(self) -> float:
        """What all draw, in terms of the motor's own current; 1 for a motor that is alone."""
        return max(self._along / self._own, 1.0) if self._own > 0.0 else 1.0

    def add(self, now_s: float, own_a: float, all_a: float) -> None:
        """Take what is drawn now; it counts less and less."""
        kept = math.exp((self._last_s - now_s) / _MEMORY_S)
        self._last_s = now_s
        self._own = kept * self._own + own_a * own_a
        self._along = kept * self._along + own_a * all_a
