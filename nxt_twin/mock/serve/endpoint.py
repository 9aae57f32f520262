"""A place where clients connect, as the serving loop needs it."""

from __future__ import annotations

from abc import ABC, abstractmethod


class Endpoint(ABC):
    """Abstract: a place at which the mock brick is served to one client at a time, never blocking."""

    @property
    @abstractmethod
    def url(self) -> str:
        """The URL at which a client reaches it."""

    @abstractmethod
    def take_in(self) -> None:
        """Accept a client, notice that one has gone, and read what it has sent."""

    @abstractmethod
    def hand_out(self) -> None:
        """Write what the brick has to say."""

    @abstractmethod
    def hang_up(self) -> None:
        """End the connection to the client, if there is one, as a brick does that is switched off."""

    @abstractmethod
    def close(self) -> None:
        """Stop serving."""
