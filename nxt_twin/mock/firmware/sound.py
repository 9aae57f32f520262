"""The sound module: what plays, and for how long. It makes no noise.

Source: LEGO NXT firmware 1.29, c_sound.c cSoundInit and cSoundCtrl, d_sound.r SoundTone.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final, final

from firmware_protocol import ModuleId, SoundMap, Status, decode_io_map, encode_io_map, limits
from nxt_twin.mock.firmware.loader import Loader, LoaderRefusal
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

_HEADER_SIZE: Final = 8
_FORMAT_SOUND: Final = 0x01
_FORMAT_MELODY: Final = 0x06
_COMPRESSED: Final = 0x01
_NOTE_SIZE: Final = 4


@final
class SoundModule(Module):
    """One sound at a time; a file that plays holds a file handle.

    Until the first sound has ended the module believes that handle 0 is its own, and closes it.

    Args:
        loader: the files.
    """

    module_id = ModuleId.SOUND
    name = "Sound.mod"

    def __init__(self, loader: Loader) -> None:
        self._map = SoundMap(0, 0, 0, "", 0, STATE_IDLE, MODE_ONCE, limits.VOLUME_MAX)
        self._loader = loader
        self._handle: int | None = 0
        self._left_ms = 0
        self._length_ms = 0

    @property
    def state(self) -> int:
        """Whether, and what, it plays."""
        return self._map.state

    @property
    def volume(self) -> int:
        """0 to 4, as GET_PROPERTY gives it."""
        return self._map.volume

    @volume.setter
    def volume(self, volume: int) -> None:
        self._map = replace(self._map, volume=volume)

    def play_tone(self, frequency_hz: int, duration_ms: int) -> None:
        """Play a tone from the next pass on, instead of whatever plays."""
        self._set(
            mode=MODE_TONE,
            frequency_hz=frequency_hz,
            duration_ms=duration_ms,
            flags=self._map.flags | _UPDATE,
        )

    def play_file(self, name: str, *, loop: bool) -> None:
        """Play a file from the next pass on, once or for ever."""
        self._set(mode=MODE_LOOP if loop else MODE_ONCE, file_name=name, flags=self._map.flags | _UPDATE)

    def stop(self) -> None:
        """Be silent from the next pass on."""
        self._set(state=STATE_STOP)

    def tick(self) -> None:
        """One pass."""
        if self._map.flags & _UPDATE:
            self._update()
        if self._map.state == STATE_STOP:
            self._close()
            self._fall_silent()
        elif self._map.state in (STATE_FILE, STATE_TONE):
            self._go_on()

    def _update(self) -> None:
        self._set(flags=self._map.flags & ~_UPDATE)
        if self._map.mode & MODE_TONE:
            self._close()
            self._left_ms = self._length_ms = self._map.duration_ms
            self._set(state=STATE_TONE)
        elif self._loader.find(self._map.file_name) is not None:
            self._close()
            self._set(flags=self._map.flags & ~_RUNNING)
            self._open()

    def _open(self) -> None:
        """Open the file; one that is no sound is closed again, yet its handle is remembered."""
        try:
            self._handle, _ = self._loader.open_read(self._map.file_name)
        except LoaderRefusal:
            self._handle = None
            return
        head, status = self._loader.read(self._handle, _HEADER_SIZE)
        if status != Status.OK:
            return
        if head[0] not in (_FORMAT_SOUND, _FORMAT_MELODY):
            self._loader.close(self._handle)
            return
        body = self._loader.rest(self._handle)
        self._length_ms = _melody_ms(body) if head[0] == _FORMAT_MELODY else self._samples_ms(head, body)
        self._left_ms = self._length_ms
        self._set(state=STATE_FILE)

    def _samples_ms(self, head: bytes, body: bytes) -> int:
        """How long samples last; the rate that a host has set counts once, before the file's own."""
        rate_hz = self._map.sample_rate_hz or int.from_bytes(head[4:6], "big")
        self._set(sample_rate_hz=0)
        samples = len(body) * (2 if head[1] == _COMPRESSED else 1)
        return samples * 1000 // rate_hz if rate_hz else 0

    def _go_on(self) -> None:
        self._set(flags=self._map.flags | _RUNNING)
        self._left_ms -= 1
        if self._left_ms > 0:
            return
        if self._map.mode & MODE_LOOP:
            self._left_ms = self._length_ms
            return
        if self._map.state == STATE_FILE:
            self._close()
        self._fall_silent()

    def _close(self) -> None:
        if self._handle is not None:
            self._loader.close(self._handle)
        self._handle = None

    def _fall_silent(self) -> None:
        self._set(flags=self._map.flags & ~_RUNNING, state=STATE_IDLE)

    def _set(self, **values: int | str) -> None:
        self._map = replace(self._map, **values)  # type: ignore[arg-type] # names and types are the map's own

    def export(self) -> bytes:
        """The IO map."""
        return encode_io_map(self._map)

    def adopt(self, data: bytes) -> None:
        """Take over the IO map; a host that sets the update flag starts a sound this way."""
        self._map = decode_io_map(SoundMap, data)


def _melody_ms(notes: bytes) -> int:
    """How long the notes of a melody last; each is a frequency and a time, big-endian."""
    return sum(
        int.from_bytes(notes[at + 2 : at + _NOTE_SIZE], "big")
        for at in range(0, len(notes) - _NOTE_SIZE + 1, _NOTE_SIZE)
    )
