"""The user interface module: battery, volume, and the timer that switches the brick off.

Source: LEGO NXT firmware 1.29, c_ui.c.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final, final

from firmware_protocol import ModuleId, UiMap, decode_io_map, encode_io_map, limits
from firmware_protocol.layout import fixed_size_of
from nxt_twin.mock.firmware.hardware import Hardware
from nxt_twin.mock.firmware.module import Module

BATTERY_PERIOD_MS: Final = 167
BATTERY_STEP_UV: Final = 13_848
"""The converter's step: readings are multiples of 13.848 mV, truncated."""
IO_MAP_SIZE: Final = 44
MINUTE_MS: Final = 60_000

_DEFAULTS: Final = UiMap(
    menu_pointer=0,
    battery_voltage_mv=0,
    file_name="",
    flags=0,
    state=0,
    button=0,
    run_state=1,
    battery_state=4,
    bluetooth_state=0,
    usb_state=0,
    sleep_timeout_min=10,
    sleep_timer_min=10,
    rechargeable=False,
    volume=limits.VOLUME_MAX,
    error=0,
    on_brick_program_step=0,
    force_off=0,
    abort_flag=False,
)


@final
class UiModule(Module):
    """Battery, volume, sleep."""

    module_id = ModuleId.UI
    name = "Ui.mod"

    def __init__(self, hardware: Hardware, *, sleep_timeout_min: int) -> None:
        self.sleep_timeout_min = sleep_timeout_min
        self.volume = limits.VOLUME_MAX
        self.bluetooth_on = True
        self.switched_off = False
        self._hardware = hardware
        self._awake_ms = 0
        self._battery_wait_ms = BATTERY_PERIOD_MS
        self.battery_mv = self._measure_battery()
        self._rest = _DEFAULTS
        self._tail = bytes(IO_MAP_SIZE - (fixed_size_of(UiMap) or 0))

    def stay_awake(self) -> None:
        """Restart the sleep timer."""
        self._awake_ms = 0

    def tick(self) -> None:
        """One pass."""
        self._battery_wait_ms -= 1
        if self._battery_wait_ms == 0:
            self._battery_wait_ms = BATTERY_PERIOD_MS
            self.battery_mv = self._measure_battery()
        self._awake_ms += 1
        if self.sleep_timeout_min and self._awake_ms >= self.sleep_timeout_min * MINUTE_MS:
            self.switched_off = True

    def _measure_battery(self) -> int:
        reading = min(1023, max(0, int(self._hardware.battery_v() * 1e6 / BATTERY_STEP_UV)))
        return reading * BATTERY_STEP_UV // 1000

    def export(self) -> bytes:
        """The IO map."""
        passed_min = self._awake_ms // MINUTE_MS
        head = replace(
            self._rest,
            battery_voltage_mv=self.battery_mv,
            volume=self.volume,
            sleep_timeout_min=self.sleep_timeout_min,
            sleep_timer_min=max(0, self.sleep_timeout_min - passed_min),
        )
        return encode_io_map(head) + self._tail

    def adopt(self, data: bytes) -> None:
        """Take over the IO map."""
        size = fixed_size_of(UiMap) or 0
        self._rest = decode_io_map(UiMap, data[:size])
        self._tail = data[size:]
        self.volume = self._rest.volume
        self.sleep_timeout_min = self._rest.sleep_timeout_min
        self.switched_off = self.switched_off or bool(self._rest.force_off)
