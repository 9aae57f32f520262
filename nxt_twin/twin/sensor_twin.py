"""Sensors beside their measurement models: what each is expected to read next, and whether a reading is believed."""

from __future__ import annotations

from typing import Literal, final

from nxt_twin.recording.columns import SensorSlot, light_column, sound_column, touch_column, ultrasonic_column
from nxt_twin.sensors import ultrasonic
from nxt_twin.twin.estimator import Drift
from nxt_twin.twin.records import Innovation

PortSensor = Literal["touch", "light", "sound", "ultrasonic"]

NO_ECHO_CM = 255.0
_GATE = 16.0
_REJECTED_MOST = 3
_STALE_S = 0.035
"""The ultrasonic sensor pings no faster than this; a reading sooner than that only repeats the last."""
_JERK = {"ultrasonic": 4e3, "light": 4e5, "sound": 4e6}
_RATE_STD = {"ultrasonic": 20.0, "light": 200.0, "sound": 1000.0}
_NOISE_VARIANCE = {"light": 4.1, "sound": 400.1}
_SWITCH_PER_S = 0.5
_MISREAD = 1e-3

_COLUMN = {
    "touch": touch_column,
    "light": light_column,
    "sound": sound_column,
    "ultrasonic": ultrasonic_column,
}
_UNIT = {"touch": "", "light": "raw", "sound": "raw", "ultrasonic": "cm"}


@final
class SensorTwin:
    """One sensor. Where nothing is known of its surroundings, its truth is a number that wanders.

    An ultrasonic reading has the variance of the sensor's own model. The filter skips 255 (no echo) and
    readings before the next ping. It rejects an impossible reading, unless such readings go on.

    Args:
        slot: of the brick.
        kind: what is plugged in.
        model: of an ultrasonic sensor.
    """

    def __init__(
        self, slot: SensorSlot, kind: PortSensor, model: ultrasonic.UltrasonicParameters | None = None
    ) -> None:
        self.slot = slot
        self.kind = kind
        self.column = _COLUMN[kind](slot)
        self._model = model or ultrasonic.UltrasonicParameters(noise_mm=5.0)
        self._drift: Drift | None = None
        self._pressed = 0.5
        self._last_s: float | None = None
        self._rejected = 0

    def read(self, time_s: float, value: float) -> Innovation | None:
        """Compare a reading and learn from it; None where there is nothing to compare it with."""
        since_s = 0.0 if self._last_s is None else time_s - self._last_s
        if self.kind == "ultrasonic" and (
            value >= NO_ECHO_CM or (self._last_s is not None and since_s < _STALE_S)
        ):
            return None
        self._last_s = time_s
        if self.kind == "touch":
            return self._touch(time_s, value, since_s)
        return self._wander(time_s, value, since_s)

    def _touch(self, time_s: float, value: float, since_s: float) -> Innovation:
        """A switch that is pressed or not, and changes now and then: exact, by Bayes' rule."""
        change = min(_SWITCH_PER_S * since_s, 0.5)
        predicted = self._pressed * (1.0 - change) + (1.0 - self._pressed) * change
        right, wrong = (1.0 - _MISREAD, _MISREAD) if value else (_MISREAD, 1.0 - _MISREAD)
        self._pressed = right * predicted / (right * predicted + wrong * (1.0 - predicted))
        variance = predicted * (1.0 - predicted) + _MISREAD
        return Innovation(time_s, self.column, "", value, predicted, variance)

    def _wander(self, time_s: float, value: float, since_s: float) -> Innovation | None:
        offset, variance = self._seen(value)
        if self._drift is None:
            self._drift = Drift(value - offset, variance, _JERK[self.kind], _RATE_STD[self.kind])
            return None
        self._drift.predict(since_s)
        compared = self._drift.compare(value - offset, variance)
        accepted = compared.normalised_square <= _GATE
        self._rejected = 0 if accepted else self._rejected + 1
        if self._rejected >= _REJECTED_MOST:
            self._drift, self._rejected = None, 0
        elif accepted:
            self._drift.update(value - offset, variance)
        return Innovation(
            time_s,
            self.column,
            _UNIT[self.kind],
            value,
            compared.predicted + offset,
            compared.variance,
            accepted,
        )

    def _seen(self, value: float) -> tuple[float, float]:
        """By how much the sensor reads more than the truth, and the variance of a reading."""
        if self.kind != "ultrasonic":
            return 0.0, _NOISE_VARIANCE[self.kind]
        truth_cm = value if self._drift is None else self._drift.value
        expected = ultrasonic.expected(self._model, 10.0 * max(truth_cm, 0.0))
        return expected.mean - max(truth_cm, 0.0), expected.variance
