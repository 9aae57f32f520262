"""The battery: what it would give without load, from readings that show whatever the motors drew."""

from __future__ import annotations

import math
import statistics
from collections import deque
from dataclasses import dataclass
from typing import NamedTuple, final

_LATELY = 9
_KEPT = 100
_MEMORY_S = 30.0
_STEPS_KEPT = 200
"""Steps of a move whose current is kept: some hundred milliseconds."""


class Draught(NamedTuple):
    """The current of all motors together while a battery's voltage was taken.

    Attributes:
        mean_a: on average, A.
        span_a: between the least and the most of it, A.
    """

    mean_a: float
    span_a: float = 0.0


class _Reading(NamedTuple):
    drawn: Draught
    terminal_v: float
    at_s: float


@final
@dataclass(frozen=True)
class Drain:
    """An open-circuit voltage that falls in time, as a motor's model has it.

    Attributes:
        v_per_s: the rate of change.
        began_s: since then.
    """

    v_per_s: float = 0.0
    began_s: float = 0.0

    def by(self, at_s: float) -> float:
        """How much is gone, V."""
        return self.v_per_s * (at_s - self.began_s)


@final
class Supply:
    """An open-circuit voltage behind an internal resistance.

    Args:
        assumed_v: until the first reading.
        resistance_ohm: of battery and contacts; what all motors draw together passes through it.
        drain: that a model has already; the voltage is then what there was at its beginning.
    """

    def __init__(self, assumed_v: float, resistance_ohm: float, drain: Drain | None = None) -> None:
        self._open_v = assumed_v
        self._resistance_ohm = resistance_ohm
        self._drain = drain or Drain()
        self._readings: deque[_Reading] = deque(maxlen=_KEPT)

    @property
    def open_v(self) -> float:
        """The estimate of the voltage without load, V."""
        return self._open_v

    def under(self, drawn_a: float) -> float:
        """The voltage at the terminals while `drawn_a` is drawn, V."""
        return max(self._open_v - self._resistance_ohm * max(drawn_a, 0.0), 0.0)

    def read(self, terminal_v: float, drawn: Draught, at_s: float = 0.0) -> None:
        """Take a reading of the terminals; the last few are believed, those under the least and steadiest current."""
        self._readings.append(_Reading(drawn, terminal_v, at_s))
        self._open_v = self._believed(list(self._readings)[: -_LATELY - 1 : -1])

    def behind(self, resistance_ohm: float, drain: Drain | None = None) -> Supply:
        """The battery by the readings so far, with another resistance and drain."""
        other = Supply(self._open_v, resistance_ohm, drain)
        for drawn, terminal_v, at_s in self._readings:
            other.read(terminal_v, drawn, at_s)
        return other

    def at(self, from_s: float) -> float:
        """The voltage without load at a moment, by all readings since then, V."""
        since = [reading for reading in self._readings if reading.at_s >= from_s]
        return (self._believed(since) if since else self._open_v) - self._drain.by(from_s)

    def _believed(self, readings: list[_Reading]) -> float:
        """The median of the quieter half: where the resistance is another, its error grows with the current.

        A current that changed while the voltage was taken errs by as much as it changed. Of readings that are as
        quiet, the first in the list count.
        """
        quiet = sorted(readings, key=lambda reading: sum(reading.drawn))[: (len(readings) + 1) // 2]
        return statistics.median(
            terminal_v + self._resistance_ohm * drawn.mean_a + self._drain.by(at_s)
            for drawn, terminal_v, at_s in quiet
        )


@final
class Lately:
    """The current of all motors together, in the last while."""

    def __init__(self) -> None:
        self._drawn: deque[tuple[float, float]] = deque(maxlen=_STEPS_KEPT)

    def add(self, at_s: float, drawn_a: float) -> None:
        """Take the current that was drawn until `at_s`, since the last call."""
        self._drawn.append((at_s, max(drawn_a, 0.0)))

    def since(self, from_s: float) -> Draught:
        """The current from a moment on; the last one, if nothing is known of then."""
        found = [drawn_a for at_s, drawn_a in self._drawn if at_s >= from_s]
        found = found or [drawn_a for _, drawn_a in self._drawn][-1:] or [0.0]
        return Draught(statistics.fmean(found), max(found) - min(found))


@final
class Company:
    """The current that all motors draw together for each ampere that one of them draws.

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
