"""The one seam between the host and a family's simulator."""

from __future__ import annotations

from abc import ABC, abstractmethod

from nxt_twin.arrays import FloatArray


class Machine(ABC):
    """A motor under way: at rest when it begins, then driven piece by piece; a recording begins at time zero."""

    @abstractmethod
    def run(self, stops_s: FloatArray, duty: float, mode: int) -> FloatArray:
        """Go on under one command, from where the last piece ended, to each of these times.

        Args:
            stops_s: increasing times, the last one the piece's end, s.
            duty: -1 to 1.
            mode: 0 drive, 1 float (PWM with an open off phase), 2 coast (open), 3 brake (shorted).

        Returns:
            Hub angle (rad), what the encoder miscounts (rad) and the battery's voltage (V) at each, shape (stops, 3).
        """
