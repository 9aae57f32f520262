"""The one seam to a brick: whole telegrams out, whole telegrams in."""

from __future__ import annotations

from typing import Protocol


class Link(Protocol):
    """Carries telegrams, without knowing what they mean. Not for several threads at once."""

    def send(self, telegram: bytes) -> None:
        """Hand one telegram over.

        Raises:
            LinkLostError: the other end is gone, or the link was closed.
            LinkTimeoutError: the other end takes nothing any more.
        """
        ...

    def receive(self, timeout_s: float) -> bytes:
        """Wait for one telegram; with a timeout of 0, give only what is there already.

        Raises:
            LinkTimeoutError: nothing came in time.
            HalfTelegramError: the start of a telegram came, and no more in time.
            GarbageError: what came cannot be cut into telegrams.
            LinkLostError: the other end is gone, or the link was closed.
        """
        ...

    def close(self) -> None:
        """Let go of the other end; closing again does nothing."""
        ...

    def describe(self) -> str:
        """The link's name for a person: the URL, and any special property."""
        ...
