"""Failures of a whole fleet; those of a single recording are rows of the table."""

from __future__ import annotations

from nxt_twin.errors import NxtTwinError


class FleetError(NxtTwinError):
    """A fleet that cannot be begun or gone on with: no recordings, no cluster, a table of something else."""
