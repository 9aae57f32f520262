"""Sensors on the analogue-to-digital converter, and the type and mode of every sensor port."""

from __future__ import annotations

from typing import Final, NamedTuple, final

from firmware_protocol import (
    GetInputValues,
    InputPort,
    ResetInputScaledValue,
    SensorMode,
    SensorType,
    SetInputMode,
)
from nxt_twin.brick.errors import LinkTimeoutError
from nxt_twin.brick.exchange import Exchange
from nxt_twin.brick.question import Question, compiled_question
from nxt_twin.brick.stamped import Stamped

_POLL_PERIOD_S: Final = 0.005


class SensorReading(NamedTuple):
    """A sensor as the input module holds it.

    Attributes:
        port: the sensor port, 0 to 3.
        valid: whether the values are those of the type set; false for 20 to 400 ms after a new type.
        calibrated: never set by the firmware.
        sensor_type: the type set.
        sensor_mode: the mode set, and its slope.
        raw: the converter's reading, 0…1023; 1023 with nothing plugged in.
        normalised: 0…1023, as the type defines it.
        scaled: as the mode defines it: 0/1, a count, percent, tenths of a degree.
        calibrated_value: the firmware repeats the normalised value.
    """

    port: int
    valid: bool
    calibrated: bool
    sensor_type: int
    sensor_mode: int
    raw: int
    normalised: int
    scaled: int
    calibrated_value: int


@final
class Sensors:
    """The sensor ports of a brick; every method raises what `Exchange.put` does."""

    def __init__(self, exchange: Exchange) -> None:
        self._exchange = exchange
        self._readings: dict[int, Question[SensorReading]] = {
            port: compiled_question(GetInputValues(port), SensorReading) for port in InputPort
        }

    def set_mode(
        self, port: int, sensor_type: int, sensor_mode: int = SensorMode.RAW, *, confirm: bool = True
    ) -> Stamped[None]:
        """Say what is plugged in and how to scale it (SET_IN_MODE); the values are invalid for a while."""
        request = SetInputMode(port, sensor_type, sensor_mode)
        return self._exchange.ask(request).having(None) if confirm else self._exchange.tell(request)

    def read(self, port: int) -> Stamped[SensorReading]:
        """The sensor's values (GET_IN_VALS)."""
        ready = self._readings.get(port) or compiled_question(GetInputValues(port), SensorReading)
        return self._exchange.put(ready)

    def read_valid(self, port: int, *, timeout_s: float = 0.6) -> Stamped[SensorReading]:
        """The first reading that is valid; sound takes 300 ms after its type was set.

        Raises:
            LinkTimeoutError: none was valid in time.
        """
        clock = self._exchange.clock
        give_up_s = clock.now_s() + timeout_s
        while not (reading := self.read(port)).value.valid:
            if clock.now_s() >= give_up_s:
                raise LinkTimeoutError(
                    f"sensor port {port + 1} has no valid reading after {timeout_s:g} s",
                    where=self._exchange.describe(),
                    mend="check what is plugged in",
                )
            clock.sleep(_POLL_PERIOD_S)
        return reading

    def reset_scaled(self, port: int) -> Stamped[None]:
        """Set the scaled value (a count, for one) to 0."""
        return self._exchange.ask(ResetInputScaledValue(port)).having(None)

    def set_up_touch(self, port: int) -> Stamped[None]:
        """A touch sensor is plugged in."""
        return self.set_mode(port, SensorType.SWITCH, SensorMode.BOOLEAN)

    def set_up_light(self, port: int, *, lamp: bool = True) -> Stamped[None]:
        """A light sensor is plugged in; its own lamp is on or off."""
        return self.set_mode(port, SensorType.LIGHT_ACTIVE if lamp else SensorType.LIGHT_INACTIVE)

    def set_up_sound(self, port: int, *, as_heard: bool = False) -> Stamped[None]:
        """A sound sensor is plugged in; `as_heard` weighs frequencies as the ear does (dBA)."""
        return self.set_mode(port, SensorType.SOUND_DBA if as_heard else SensorType.SOUND_DB)

    def pressed(self, port: int) -> Stamped[bool]:
        """Whether the touch sensor is pressed."""
        reading = self.read(port)
        return reading.having(reading.value.scaled != 0)
