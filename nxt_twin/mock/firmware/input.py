"""The input module: four sensor ports with types, modes, waiting times and counters.

Source: LEGO NXT firmware 1.29, c_input.c. No colour sensor is ever attached: its types stay invalid.
"""

from __future__ import annotations

from typing import Final, final

from firmware_protocol import (
    InputMap,
    InputPortBlock,
    ModuleId,
    SensorMode,
    SensorType,
    decode_io_map,
    encode_io_map,
    limits,
)
from nxt_twin.mock.firmware.hardware import Hardware
from nxt_twin.mock.firmware.integers import s16
from nxt_twin.mock.firmware.module import Module
from nxt_twin.mock.firmware.scaling import FULL_SCALE, ConverterSpan, fahrenheit_tenths, normalised

INVALID_MS: Final = 20
INVALID_SOUND_MS: Final = 300
INVALID_COLOR_MS: Final = 400
DEBOUNCE_TICKS: Final = 100

FALSE_ABOVE: Final = 460
"""45 % of full scale. The threshold for true, 55 %, is never asked: the two are crossed in the firmware."""

_MODE_MASK: Final = 0xE0
_SLOPE_MASK: Final = 0x1F
_SOUND_TYPES: Final = frozenset({SensorType.SOUND_DB, SensorType.SOUND_DBA})
_COLOR_TYPES: Final = frozenset(range(SensorType.COLOR_FULL, SensorType.COLOR_EXIT + 1))
_ANGLE_LIMITS: Final = (400, 600, 800)
_ANGLE_STEPS: Final = {
    (0, 1): 1,
    (0, 2): -1,
    (1, 3): 1,
    (1, 0): -1,
    (2, 0): 1,
    (2, 3): -1,
    (3, 2): 1,
    (3, 1): -1,
}
_COUNTING: Final = frozenset({SensorMode.TRANSITION_COUNT, SensorMode.PERIOD_COUNT, SensorMode.ANGLE_STEPS})


@final
class InputPortState:
    """A sensor's part of the IO map, and what the module remembers of it."""

    __slots__ = (
        "_debounce",
        "_edges",
        "_last_quadrant",
        "_settled",
        "_type_in_force",
        "_wait_ms",
        "ad_raw",
        "boolean",
        "custom_active",
        "custom_percent",
        "custom_zero_offset",
        "digital_direction",
        "digital_in",
        "digital_out",
        "invalid_data",
        "sensor_mode",
        "sensor_raw",
        "sensor_type",
        "sensor_value",
        "spare",
    )

    def __init__(self) -> None:
        self.custom_zero_offset = 0
        self.ad_raw = 0
        self.sensor_raw = 0
        self.sensor_value = 0
        self.sensor_type = 0
        self.sensor_mode = 0
        self.boolean = False
        self.digital_direction = self.digital_in = self.digital_out = 0
        self.custom_percent = 0
        self.custom_active = 0
        self.invalid_data = True
        self.spare = bytes(3)
        self._type_in_force = 0
        self._wait_ms = INVALID_MS
        self._settled = -1
        self._clear_counters()

    def _clear_counters(self) -> None:
        self._debounce = 0
        self._edges = 0
        self._last_quadrant = 0

    def set_mode(self, sensor_type: int, sensor_mode: int) -> None:
        """What SET_IN_MODE does: store type and mode unchecked; the data are invalid until the next tick."""
        self.sensor_type = sensor_type
        self.sensor_mode = sensor_mode
        self.invalid_data = True
        self._settled = -1

    def reset_value(self) -> None:
        """What RESET_IN_VAL does."""
        self.sensor_value = 0
        self._settled = -1

    def clear(self) -> None:
        """Do what the start and the stop of a program do."""
        self.set_mode(SensorType.NO_SENSOR, SensorMode.RAW)
        self.ad_raw = self.sensor_raw = self.sensor_value = 0
        self.boolean = False

    @property
    def forgetful(self) -> bool:
        """Nothing here depends on any reading but the last one: those before need not be taken."""
        settled = self._settled >= 0 and not self.invalid_data and self.sensor_type == self._type_in_force
        return settled and not self.sensor_mode & _SLOPE_MASK

    def tick(self, raw: int) -> bool:
        """One pass with the converter's reading; True if the sensor type has just changed."""
        if not self.invalid_data and raw == self._settled and self.sensor_type == self._type_in_force:
            return False
        changed = self.sensor_type != self._type_in_force
        if changed:
            self._start_type()
        elif self._wait_ms:
            self._wait()
        else:
            self.invalid_data = False
        if not self.invalid_data:
            self._measure(raw)
        return changed

    def _start_type(self) -> None:
        self._clear_counters()
        self._type_in_force = self.sensor_type
        self.invalid_data = True
        if self.sensor_type in _SOUND_TYPES:
            self._wait_ms = INVALID_SOUND_MS
        elif self.sensor_type in _COLOR_TYPES:
            self._wait_ms = INVALID_COLOR_MS
        else:
            self._wait_ms = INVALID_MS

    def _wait(self) -> None:
        if self.sensor_type in _COLOR_TYPES:
            self._wait_ms = INVALID_COLOR_MS
            return
        self._wait_ms -= 1
        if self._wait_ms == 0:
            self.invalid_data = False

    def _measure(self, raw: int) -> None:
        reading = normalised(
            self.sensor_type, raw, ConverterSpan(self.custom_zero_offset, self.custom_percent)
        )
        if reading is None:
            self._settled = raw
            return
        self.ad_raw = raw
        truth = self._truth(reading)
        changing = reading != self.sensor_raw
        self.sensor_raw = reading
        self._convert(reading, truth=truth)
        self.boolean = truth
        counting = self.sensor_mode & _MODE_MASK in _COUNTING
        sloped = self.sensor_mode & _SLOPE_MASK
        self._settled = -1 if counting or (sloped and changing) else raw

    def _truth(self, reading: int) -> bool:
        slope = self.sensor_mode & _SLOPE_MASK
        if slope == 0:
            return reading <= FALSE_ABOVE
        if reading > FULL_SCALE - slope:
            return False
        if reading < slope:
            return True
        fall = self.sensor_raw - reading
        return fall > slope or (self.boolean and fall >= -slope)

    def _convert(self, reading: int, *, truth: bool) -> None:
        match self.sensor_mode & _MODE_MASK:
            case SensorMode.RAW:
                self.sensor_value = reading
            case SensorMode.BOOLEAN:
                self.sensor_value = int(truth)
            case SensorMode.TRANSITION_COUNT:
                if self._is_edge(truth=truth):
                    self.sensor_value = s16(self.sensor_value + 1)
            case SensorMode.PERIOD_COUNT:
                self._count_periods(truth=truth)
            case SensorMode.PERCENT:
                self.sensor_value = reading * 100 // FULL_SCALE
            case SensorMode.CELSIUS:
                self.sensor_value = reading * 900 // FULL_SCALE - 200
            case SensorMode.FAHRENHEIT:
                self.sensor_value = fahrenheit_tenths(reading * 900 // FULL_SCALE - 200)
            case SensorMode.ANGLE_STEPS:
                self._count_quadrants(reading)

    def _is_edge(self, *, truth: bool) -> bool:
        if self._debounce:
            self._debounce -= 1
            return False
        if self.boolean == truth:
            return False
        self._debounce = DEBOUNCE_TICKS
        return True

    def _count_periods(self, *, truth: bool) -> None:
        if not self._is_edge(truth=truth):
            return
        self._edges += 1
        if self._edges > 1 and not truth:
            self._edges = 0
            self.sensor_value = s16(self.sensor_value + 1)

    def _count_quadrants(self, reading: int) -> None:
        quadrant = sum(reading >= limit for limit in _ANGLE_LIMITS)
        step = _ANGLE_STEPS.get((self._last_quadrant, quadrant))
        if step is not None:
            self.sensor_value = s16(self.sensor_value + step)
            self._last_quadrant = quadrant

    def export(self) -> InputPortBlock:
        """The port as it lies in the IO map."""
        names = (name for name in InputPortState.__slots__ if not name.startswith("_"))
        return InputPortBlock(**{name: getattr(self, name) for name in names})

    def adopt(self, block: InputPortBlock) -> None:
        """Take over the port from the IO map."""
        for name in (name for name in InputPortState.__slots__ if not name.startswith("_")):
            value = getattr(block, name)
            setattr(self, name, value if isinstance(value, bool | bytes) else int(value))
        self._settled = -1


@final
class InputModule(Module):
    """Four sensor ports."""

    module_id = ModuleId.INPUT
    name = "Input.mod"

    def __init__(self, hardware: Hardware) -> None:
        self.ports = tuple(InputPortState() for _ in range(limits.INPUT_PORT_COUNT))
        self._colors = bytes(limits.IO_MAP_SIZES[ModuleId.INPUT] - 20 * limits.INPUT_PORT_COUNT)
        self._hardware = hardware
        self._readings = [hardware.analog(port) for port in range(limits.INPUT_PORT_COUNT)]
        self._stale = [False] * limits.INPUT_PORT_COUNT
        self._converter_turn = False

    def tick(self) -> None:
        """One pass; new readings come from the co-processor every other one.

        Most sensors are read far less often than that. A reading that only the next one would replace is not taken.
        """
        self._converter_turn = not self._converter_turn
        if not self._converter_turn:
            self._stale = [True] * limits.INPUT_PORT_COUNT
        for index, port in enumerate(self.ports):
            if not port.forgetful:
                self._pass(index, port)

    def _pass(self, index: int, port: InputPortState) -> None:
        if self._stale[index]:
            self._stale[index] = False
            self._readings[index] = self._hardware.analog(index)
        if port.tick(self._readings[index]):
            self._hardware.set_sensor_type(index, port.sensor_type)

    def look(self, index: int) -> InputPortState:
        """A port for somebody who reads it: with the converter's last reading."""
        port = self.ports[index]
        if self._stale[index] and port.forgetful:
            self._pass(index, port)
        return port

    def reset(self) -> None:
        """Do what the start and the stop of a program do: no sensors, all values 0."""
        for port in self.ports:
            port.clear()

    def export(self) -> bytes:
        """The IO map."""
        return encode_io_map(
            InputMap(tuple(self.look(i).export() for i in range(len(self.ports))), self._colors)
        )

    def adopt(self, data: bytes) -> None:
        """Take over the IO map."""
        given = decode_io_map(InputMap, data)
        for port, block in zip(self.ports, given.ports, strict=True):
            port.adopt(block)
        self._colors = given.color_blocks
