"""Failures of this package."""

from __future__ import annotations

from nxt_twin.errors import NxtTwinError


class SensorError(NxtTwinError):
    """A sensor model with a wrong key or value, or readings that do not fit their truth."""
