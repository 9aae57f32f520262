"""Evidence that adds up: since when, how much, and in which regime a model is beaten by an unknown torque."""

from __future__ import annotations

from collections import deque
from typing import final

from nxt_twin.twin.settings import Watch

LOW_SPEED, HIGH_SPEED, REVERSAL, AFTER_COMMAND, STEADY = (
    "at low speed",
    "at high speed",
    "just after the direction changes",
    "just after a command changes",
    "at steady speed",
)
_SLOW_RAD_S = 2.0
_FAST_RAD_S = 8.0
_AFTER_S = 0.25
_LIKELIER = 0.5


@final
class Tally:
    """A cumulative sum of what each reading says, that never falls below nothing (Page 1954).

    Attributes:
        nats: the sum now.
        since_s: when it last began to rise.
    """

    def __init__(self) -> None:
        self.nats = 0.0
        self.since_s = 0.0
        self._pushes = 0.0
        self._readings = 0
        self._by_regime: dict[str, float] = {}

    @property
    def push(self) -> float:
        """The unknown torque in the direction of the motion, N·m, on average since `since_s`."""
        return self._pushes / max(self._readings, 1)

    @property
    def regime(self) -> str | None:
        """Where most of the evidence comes from, if more than half of it does."""
        gains = {regime: nats for regime, nats in self._by_regime.items() if nats > 0.0}
        if not gains:
            return None
        best = max(gains, key=lambda regime: gains[regime])
        return best if gains[best] > 0.5 * sum(gains.values()) else None

    def add(self, nats: float, time_s: float, speed: float, torque: float, regime: str) -> None:
        """Take what one reading says."""
        if self.nats + nats <= 0.0:
            self.clear(time_s)
            return
        self.nats += nats
        self._by_regime[regime] = self._by_regime.get(regime, 0.0) + nats
        self._pushes += torque if speed >= 0.0 else -torque
        self._readings += 1

    def clear(self, time_s: float) -> None:
        """Begin anew."""
        self.nats, self.since_s = 0.0, time_s
        self._pushes, self._readings = 0.0, 0
        self._by_regime.clear()


@final
class Doubt:
    """How long the model has been hardly possible, by the effects that are weighed.

    Args:
        watch: when that is.

    Attributes:
        since_s: when the model was last the likelier one.
    """

    def __init__(self, watch: Watch) -> None:
        self._watch = watch
        self._unlikely_s: float | None = None
        self.since_s = 0.0

    def take(self, time_s: float, nothing: float) -> bool:
        """Take the probability that nothing is missing; True while it has been hardly any for long enough."""
        if nothing > _LIKELIER:
            self.since_s = time_s
        if nothing > self._watch.doubt:
            self._unlikely_s = None
            return False
        if self._unlikely_s is None:
            self._unlikely_s = time_s
        return time_s - self._unlikely_s >= self._watch.doubt_s

    def clear(self, time_s: float) -> None:
        """Begin anew."""
        self._unlikely_s, self.since_s = None, time_s


@final
class Strays:
    """Readings of late that no motion explains.

    Args:
        watch: how many are too many.
    """

    def __init__(self, watch: Watch) -> None:
        self._watch = watch
        self._times_s: deque[float] = deque()

    @property
    def since_s(self) -> float:
        """When the first of them was taken."""
        return self._times_s[0]

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self._times_s)

    def take(self, time_s: float, *, believed: bool) -> bool:
        """Take whether a reading was believed; True where too many were not."""
        while self._times_s and self._times_s[0] < time_s - self._watch.stray_s:
            self._times_s.popleft()
        if believed:
            return False
        self._times_s.append(time_s)
        return self.count >= self._watch.stray_most

    def clear(self) -> None:
        """Begin anew."""
        self._times_s.clear()


@final
class Regimes:
    """Says in which regime a motor is."""

    def __init__(self) -> None:
        self._sign = 0
        self._turned_s = -1.0
        self._changed_s = -1.0
        self._power = 0

    def of(self, time_s: float, speed: float, power_pct: int) -> str:
        """The regime at a moment."""
        if power_pct != self._power:
            self._power, self._changed_s = power_pct, time_s
        sign = (speed > 0.3) - (speed < -0.3)
        if sign and sign == -self._sign:
            self._turned_s = time_s
        self._sign = sign or self._sign
        if 0.0 <= time_s - self._turned_s < _AFTER_S and self._turned_s >= 0.0:
            return REVERSAL
        if 0.0 <= time_s - self._changed_s < _AFTER_S and self._changed_s >= 0.0:
            return AFTER_COMMAND
        if abs(speed) < _SLOW_RAD_S:
            return LOW_SPEED
        return HIGH_SPEED if abs(speed) > _FAST_RAD_S else STEADY
