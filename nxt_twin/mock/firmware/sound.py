"""The sound module: what plays, and for how long. It makes no noise.

Source: LEGO NXT firmware 1.29, c_sound.c.
"""

from __future__ import annotations

from typing import Final, final

from firmware_protocol import ModuleId, SoundMap, decode_io_map, encode_io_map, limits
from nxt_twin.mock.firmware.module import Module

STATE_IDLE: Final = 0
STATE_FILE: Final = 2
STATE_TONE: Final = 3
STATE_STOP: Final = 4

MODE_ONCE: Final = 0
MODE_LOOP: Final = 1
MODE_TONE: Final = 2

_UPDATE: Final = 0x01
_RUNNING: Final = 0x02


@final
class SoundModule(Module):
    """One sound at a time."""

    module_id = ModuleId.SOUND
    name = "Sound.mod"

    def __init__(self) -> None:
        self._map = SoundMap(0, 0, 8000, "", 0, STATE_IDLE, MODE_ONCE, limits.VOLUME_MAX)
        self._left_ms = 0

    @property
    def state(self) -> int:
        """Whether, and what, it plays."""
        return self._map.state

    def play_tone(self, frequency_hz: int, duration_ms: int) -> None:
        """Play a tone instead of whatever plays."""
        self._set(frequency_hz, duration_ms, "", STATE_TONE, MODE_TONE)
        self._left_ms = duration_ms

    def play_file(self, name: str, size: int, *, loop: bool) -> None:
        """Play a file of `size` bytes, one sample a byte, once or for ever."""
        self._set(0, 0, name, STATE_FILE, MODE_LOOP if loop else MODE_ONCE)
        self._left_ms = size * 1000 // self._map.sample_rate_hz

    def stop(self) -> None:
        """Be silent."""
        self._set(self._map.frequency_hz, self._map.duration_ms, "", STATE_IDLE, self._map.mode)

    def _set(self, frequency_hz: int, duration_ms: int, name: str, state: int, mode: int) -> None:
        flags = _RUNNING if state != STATE_IDLE else 0
        rate_hz, volume = self._map.sample_rate_hz or 8000, self._map.volume
        self._map = SoundMap(frequency_hz, duration_ms, rate_hz, name, flags, state, mode, volume)

    def tick(self) -> None:
        """One pass."""
        if self._map.state in (STATE_IDLE, STATE_STOP) or self._map.mode == MODE_LOOP:
            return
        self._left_ms -= 1
        if self._left_ms <= 0:
            self.stop()

    def export(self) -> bytes:
        """The IO map."""
        return encode_io_map(self._map)

    def adopt(self, data: bytes) -> None:
        """Take over the IO map; a host that sets the update flag starts a sound this way."""
        given = decode_io_map(SoundMap, data)
        self._map = given
        if given.state == STATE_STOP:
            self.stop()
        elif given.flags & _UPDATE and given.mode == MODE_TONE:
            self.play_tone(given.frequency_hz, given.duration_ms)
