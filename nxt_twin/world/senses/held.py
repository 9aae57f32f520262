"""A sensor that measures at its own pace: between two measurements it shows the last one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, final

ANALOG_PERIOD_S: Final = 0.003
"""How often the brick's co-processor converts a sensor's voltage."""
_ROUNDING_S: Final = 1e-9


@final
class Held:
    """A reading that is measured every `period_s` and held in between; the mock's `SensorView`.

    Args:
        measure: measures now; it is told the time, s.
        period_s: how often.
    """

    def __init__(self, measure: Callable[[float], float], period_s: float = ANALOG_PERIOD_S) -> None:
        self._measure = measure
        self._period_s = period_s
        self._due_s = 0.0
        self._last = 0.0

    def at(self, time_s: float) -> float:
        """The last measurement at a time since power-on."""
        if time_s + _ROUNDING_S >= self._due_s:
            self._last = self._measure(time_s)
            self._due_s = ((time_s + _ROUNDING_S) // self._period_s + 1.0) * self._period_s
        return self._last
