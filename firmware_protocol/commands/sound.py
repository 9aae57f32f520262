"""Sound: play a file, play a tone, stop.

Source: LEGO NXT firmware 1.29, c_cmd.c cCmdHandleRemoteCommands.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from firmware_protocol.command import DirectCommand, NoData
from firmware_protocol.fields import U16, Bool8, Name20


@final
@dataclass(frozen=True)
class PlaySoundFile(DirectCommand[NoData], opcode=0x02, name="PLAY_SOUND_FILE"):
    """Play a sound file once, or over and over."""

    loop: Bool8
    name: Name20


@final
@dataclass(frozen=True)
class PlayTone(DirectCommand[NoData], opcode=0x03, name="PLAY_TONE"):
    """Play a tone; the firmware checks no range."""

    frequency_hz: U16
    duration_ms: U16


@final
@dataclass(frozen=True)
class StopSound(DirectCommand[NoData], opcode=0x0C, name="STOP_SOUND"):
    """Stop whatever sounds."""
