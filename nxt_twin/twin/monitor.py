"""Says in words when a motor leaves its model, and tells trouble of other kinds from missing physics."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import final

from nxt_twin.recording.columns import Port, tacho_column
from nxt_twin.twin.blocked import TurnedBack
from nxt_twin.twin.candidates import NOTHING, UNKNOWN
from nxt_twin.twin.motor import ReadingEvidence
from nxt_twin.twin.records import Event, EventKind
from nxt_twin.twin.settings import Watch
from nxt_twin.twin.standstill import Standstill
from nxt_twin.twin.tally import Doubt, Regimes, Strays, Tally

_MOVING_RAD_S = 0.5
_BRIEF_S = 1.0
_SURE = 0.8
_ENOUGH_S = 2.0
_SEEN_S = 5.0
"""By so much later all is said to be well again where a motor was stopped: whatever stopped it is seldom met."""


@final
class MotorMonitor:
    """Watches one motor.

    Args:
        port: of the brick.
        watch: thresholds.

    Attributes:
        diverging: whether the motor is off its model.
        since_s: since when.
    """

    def __init__(self, port: Port, watch: Watch) -> None:
        self._port = port
        self._who = f"port {port.upper()}"
        self._watch = watch
        self._tally = Tally()
        self._doubt = Doubt(watch)
        self._strays = Strays(watch)
        self._regimes = Regimes()
        self._standstill = Standstill(watch)
        self._turned_back = TurnedBack()
        self._last_s: float | None = None
        self._well_s = 0.0
        self._named: str | None = None
        self._favourite: tuple[str, float] = ("", 0.0)
        self._pushed_s = 0.0
        self._proving = False
        self.diverging = False
        self.since_s = 0.0

    @property
    def trouble(self) -> str | None:
        """`stall` or `disconnected`, while it lasts."""
        return self._standstill.trouble

    def take(
        self, time_s: float, evidence: ReadingEvidence, power_pct: int, effects: Mapping[str, float]
    ) -> Iterator[Event]:
        """Take what one reading said, and the probabilities of the effects; yield what is to be said."""
        moving_s = self._moving_s(time_s, evidence.speed)
        if self._standstill.take(time_s, evidence.tacho_deg, power_pct, evidence.believed.normalised_square):
            self._turned_back.blocked(
                self._standstill.since_s, evidence.tacho_deg, 1 if power_pct > 0 else -1
            )
            yield self._trouble(time_s, power_pct)
        if self._standstill.trouble:
            self._tally.clear(time_s)
            return
        blocked_s = self._turned_back.take(evidence.tacho_deg)
        if blocked_s is not None and not self.diverging:
            yield self._alarm_at_block(time_s, blocked_s)
        regime = self._regimes.of(time_s, evidence.speed, power_pct)
        self._tally.add(evidence.nats, time_s, evidence.speed, evidence.torque, regime)
        doubted = self._doubt.take(time_s, effects.get(NOTHING, 1.0))
        strayed = self._strays.take(time_s, believed=evidence.innovation.accepted)
        held = self._standstill.pending
        if self._tally.nats >= self._watch.alarm_nats and not held:
            yield from self._alarm(time_s)
        elif doubted and not held:
            yield from self._alarm_by_name(time_s, effects)
        elif strayed and not held:
            yield from self._alarm_by_readings(time_s)
        elif self.diverging or self._proving:
            yield from self._recover(time_s, moving_s)
        if self.diverging:
            yield from self._name(time_s, effects)

    def forget(self, time_s: float, *, proving: bool = False) -> None:
        """Begin anew: the brick was away, or the model is another, which has to prove itself."""
        self._tally.clear(time_s)
        self._doubt.clear(time_s)
        self._strays.clear()
        self._turned_back.clear()
        self.diverging = False
        self._proving = proving
        self._well_s = 0.0
        self._named = None
        self._last_s = None

    def _moving_s(self, time_s: float, speed: float) -> float:
        passed_s = 0.0 if self._last_s is None else time_s - self._last_s
        self._last_s = time_s
        return passed_s if abs(speed) > _MOVING_RAD_S else 0.0

    def _alarm(self, time_s: float) -> Iterator[Event]:
        tally = self._tally
        self._well_s = 0.0
        self._pushed_s = time_s
        if not self.diverging:
            self.diverging, self.since_s, self._named = True, tally.since_s, None
            self._proving = False
            how = "faster" if tally.push > 0.0 else "slower"
            where = f", most {tally.regime}" if tally.regime else ""
            words = f"{self._who}: from {tally.since_s:.1f} s on, the motor turns {how} than its model predicts{where}"
            yield self._event(time_s, "divergence", words, tally.since_s, tally.nats)
        tally.clear(time_s)

    def _alarm_by_name(self, time_s: float, effects: Mapping[str, float]) -> Iterator[Event]:
        """What is weighed leaves the model hardly a chance, though no single stretch is far off."""
        self._well_s = 0.0
        self._pushed_s = time_s
        if self.diverging:
            return
        self.diverging, self._proving, self._named = True, False, None
        self.since_s = self._doubt.since_s
        words = f"{self._who}: from {self.since_s:.1f} s on, the motor does not turn as its model predicts"
        strength = -math.log(max(effects[NOTHING], 1e-30))
        yield self._event(time_s, "divergence", words, self.since_s, strength)

    def _alarm_at_block(self, time_s: float, blocked_s: float) -> Event:
        """What it ran against is no trouble if it stays there: its model lacks it."""
        self._well_s, self._pushed_s, self.since_s = -_SEEN_S, time_s, blocked_s
        self.diverging, self._proving, self._named = True, False, None
        words = (
            f"{self._who}: from {blocked_s:.1f} s on, something stopped the motor, which then turned back freely: "
            "its model has no such stop"
        )
        return self._event(time_s, "divergence", words, blocked_s, None)

    def _alarm_by_readings(self, time_s: float) -> Iterator[Event]:
        """Single readings are far off, again and again, and those between them are not."""
        strays = self._strays
        self._well_s = 0.0
        self._pushed_s = time_s
        if not self.diverging:
            self.diverging, self._proving, self._named = True, False, None
            self.since_s = strays.since_s
            words = (
                f"{self._who}: from {self.since_s:.1f} s on, {strays.count} readings fit no motion of the motor: "
                "they are stale, or the encoder errs"
            )
            yield self._event(time_s, "divergence", words, self.since_s, float(strays.count))
        strays.clear()

    def _recover(self, time_s: float, moving_s: float) -> Iterator[Event]:
        self._well_s += moving_s
        if self._well_s < self._watch.calm_s:
            return
        lasted_s = self._pushed_s - self.since_s
        brief = self.diverging and lasted_s < _BRIEF_S
        self.diverging = self._proving = False
        if brief:
            words = (
                f"{self._who}: a push or a slip lasted {max(lasted_s, 0.1):.1f} s from {self.since_s:.1f} s on; "
                "the model holds before and after it"
            )
            yield self._event(time_s, "slip", words, self.since_s, None)
        words = f"{self._who}: the motor turns as its model predicts again"
        yield self._event(time_s, "calm", words, None, None)

    def _name(self, time_s: float, effects: Mapping[str, float]) -> Iterator[Event]:
        named = {name: p for name, p in effects.items() if name not in (NOTHING, UNKNOWN)}
        if not named:
            return
        best = max(named, key=lambda name: named[name])
        if named[best] < _SURE:
            self._favourite = ("", time_s)
            return
        if self._favourite[0] != best:
            self._favourite = (best, time_s)
        if time_s - self._favourite[1] >= _ENOUGH_S and self._named != best:
            self._named = best
            words = (
                f"{self._who}: of the effects that the twin weighs, {best.replace('_', ' ')} is the likeliest "
                f"(probability {named[best]:.2f})"
            )
            yield self._event(time_s, "effect_named", words, self.since_s, named[best])

    def _trouble(self, time_s: float, power_pct: int) -> Event:
        if self._standstill.trouble == "disconnected":
            words = f"{self._who}: the encoder counts nothing at {power_pct} % power; check the motor's cable"
            return self._event(time_s, "disconnected", words, None, None)
        words = f"{self._who}: the motor does not turn at {power_pct} % power; something blocks it"
        return self._event(time_s, "stall", words, None, None)

    def _event(
        self, time_s: float, kind: EventKind, words: str, onset_s: float | None, strength: float | None
    ) -> Event:
        return Event(time_s, kind, words, self._port, tacho_column(self._port), onset_s, strength)
