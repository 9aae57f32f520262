"""The second harmonic of a wave that goes round with the angle."""

from __future__ import annotations

from nxt_twin.physics.parameter import NUMBER, Parameter

_COMMON = 0.15  # of the first harmonic: how large the second commonly is, one standard deviation


def harmonic(name: str, symbol: str) -> Parameter:
    """A part of the second harmonic, over the first: magnets, slots and discs have one, small beside the first."""
    return Parameter(name, symbol, "1", NUMBER, (0.0,), -1.0, 1.0, _COMMON, otherwise=0.0, shapes=True)
