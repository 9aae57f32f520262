"""What can be wrong with a mock brick's surroundings."""

from __future__ import annotations

from nxt_twin.errors import NxtTwinError


class WorldError(NxtTwinError):
    """A world file that does not describe a brick's surroundings."""


class ServeError(NxtTwinError):
    """A place at which the mock brick cannot be served."""
