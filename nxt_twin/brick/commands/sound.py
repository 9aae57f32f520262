"""The brick's loudspeaker."""

from __future__ import annotations

from typing import final

from firmware_protocol import PlaySoundFile, PlayTone, StopSound
from nxt_twin.brick.exchange import Exchange
from nxt_twin.brick.stamped import Stamped


@final
class SoundPlayer:
    """Plays tones and files; every method raises what `Exchange.put` does."""

    def __init__(self, exchange: Exchange) -> None:
        self._exchange = exchange

    def play_tone(self, frequency_hz: int, duration_ms: int) -> Stamped[None]:
        """Play a tone; the brick answers before it ends."""
        return self._exchange.ask(PlayTone(frequency_hz, duration_ms)).having(None)

    def play_file(self, name: str, *, loop: bool = False) -> Stamped[None]:
        """Play a sound file once, or over and over."""
        return self._exchange.ask(PlaySoundFile(loop, name)).having(None)

    def stop(self) -> Stamped[None]:
        """Stop whatever sounds."""
        return self._exchange.ask(StopSound()).having(None)
