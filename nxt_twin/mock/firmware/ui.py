"""The user interface module: battery, volume, and the timer that switches the brick off.

Source: LEGO NXT firmware 1.29, c_ui.c and c_ui.iom.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final, final

from firmware_protocol import ModuleId, UiMap, decode_io_map, encode_io_map, limits
from nxt_twin.mock.firmware.hardware import Hardware
from nxt_twin.mock.firmware.module import Module

BATTERY_PERIOD_MS: Final = 167
BATTERY_STEP_UV: Final = 13_848
"""The converter's step: readings are multiples of 13.848 mV, truncated."""
MINUTE_MS: Final = 60_000

FLAG_RESET_SLEEP_TIMER: Final = 0x10
FLAG_EXECUTE_FILE: Final = 0x20
FLAG_BUSY: Final = 0x40
_FLAG_STATUS_LINE: Final = 0x80
_FLAG_BUTTONS_LOCKED: Final = 0x06
_KEPT_FLAGS: Final = _FLAG_STATUS_LINE | FLAG_BUSY | FLAG_EXECUTE_FILE | _FLAG_BUTTONS_LOCKED

STATE_MENU: Final = 7
"""Waiting for buttons."""

_DEFAULTS: Final = UiMap(
    menu_pointer=0,
    battery_voltage_mv=0,
    file_name="",
    flags=_FLAG_STATUS_LINE,
    state=STATE_MENU,
    button=0,
    run_state=1,
    battery_state=4,
    bluetooth_state=0,
    usb_state=0,
    sleep_timeout_min=10,
    sleep_timer_min=0,
    rechargeable=False,
    volume=limits.VOLUME_MAX,
    error=0,
    on_brick_program_step=0,
    force_off=0,
)


@final
class UiModule(Module):
    """Battery, volume, sleep.

    Attributes:
        flags: what the IO map says; `launcher` looks at them and sets them.
        state: what the display shows, likewise.
        file_name: of the file to execute.
    """

    module_id = ModuleId.UI
    name = "Ui.mod"

    def __init__(self, hardware: Hardware, *, sleep_timeout_min: int) -> None:
        self.sleep_timeout_min = sleep_timeout_min
        self.volume = limits.VOLUME_MAX
        self.bluetooth_on = True
        self.switched_off = False
        self.flags = _DEFAULTS.flags
        self.state = _DEFAULTS.state
        self.file_name = ""
        self._hardware = hardware
        self._awake_ms = 0
        self._battery_wait_ms = BATTERY_PERIOD_MS
        self.battery_mv = self._measure_battery()
        self._rest = _DEFAULTS

    def stay_awake(self) -> None:
        """Restart the sleep timer."""
        self._awake_ms = 0

    def lock_buttons(self, *, locked: bool) -> None:
        """Take the buttons from the menus for a program, or give them back."""
        self.flags = self.flags & ~_FLAG_BUTTONS_LOCKED | (_FLAG_BUTTONS_LOCKED if locked else 0)

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
        whole = replace(
            self._rest,
            battery_voltage_mv=self.battery_mv,
            file_name=self.file_name,
            flags=self.flags,
            state=self.state,
            volume=self.volume,
            sleep_timeout_min=self.sleep_timeout_min,
            sleep_timer_min=self._awake_ms // MINUTE_MS & 0xFF,
        )
        return encode_io_map(whole)

    def adopt(self, data: bytes) -> None:
        """Take over the IO map; a host that sets the flag for it has a file executed."""
        given = decode_io_map(UiMap, data)
        self._rest = given
        self.file_name = given.file_name
        self.flags = given.flags & _KEPT_FLAGS
        self.volume = given.volume
        self.sleep_timeout_min = given.sleep_timeout_min
        self.switched_off = self.switched_off or bool(given.force_off)
        if given.flags & FLAG_RESET_SLEEP_TIMER:
            self.stay_awake()
