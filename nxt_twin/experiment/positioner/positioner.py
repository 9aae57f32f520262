"""The one seam to whatever moves things in an experiment."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal, Protocol, final

from nxt_twin.experiment.errors import PositionerError

PositionerAxis = Literal["distance_mm", "angle_deg", "force_g", "compression_mm", "position_mm"]


@final
@dataclass(frozen=True)
class Limits:
    """Between what values an axis may go; in the axis' unit.

    Attributes:
        lowest, highest: the ends, which belong to it.
    """

    lowest: float
    highest: float


WIDEST: Final[Mapping[PositionerAxis, Limits]] = MappingProxyType(
    {
        "distance_mm": Limits(0.0, 3000.0),
        "angle_deg": Limits(-90.0, 90.0),
        "force_g": Limits(0.0, 500.0),
        "compression_mm": Limits(0.0, 4.0),
        "position_mm": Limits(-500.0, 500.0),
    }
)
"""What no experiment goes beyond, whatever its file says; 4 mm is the whole travel of the button."""

UNITS: Final[Mapping[PositionerAxis, str]] = MappingProxyType(
    {"distance_mm": "mm", "angle_deg": "deg", "force_g": "g", "compression_mm": "mm", "position_mm": "mm"}
)


class Positioner(Protocol):
    """Moves one axis of a rig and says where it is.

    Every experiment ends with `stop` and `close`, also after an error. Both may be called again, and neither raises
    for a lost connection.
    """

    @property
    def axis(self) -> PositionerAxis:
        """The axis that it moves."""
        ...

    @property
    def limits(self) -> Limits:
        """Where it may go."""
        ...

    def move_to(self, value: float) -> float:
        """Go there and stand still; gives the place reached, as exactly as it is known.

        Raises:
            PositionerError: it is out of the limits, stuck, or does not answer.
        """
        ...

    def stop(self) -> None:
        """Stand still at once, and let go where that is safe."""
        ...

    def close(self) -> None:
        """Stop, and give back what it holds."""
        ...


class OneAxis:
    """What all positioners have in common: the axis that they move, and between what limits.

    Args:
        axis: what is moved.
        limits: where it may go; anywhere that no experiment goes beyond if None.
    """

    def __init__(self, axis: PositionerAxis, limits: Limits | None = None) -> None:
        self._axis = axis
        self._limits = limits or WIDEST[axis]

    @property
    def axis(self) -> PositionerAxis:
        """The axis that it moves."""
        return self._axis

    @property
    def limits(self) -> Limits:
        """Where it may go."""
        return self._limits

    def stop(self) -> None:
        """Nothing moves by itself."""

    def close(self) -> None:
        """Nothing is held."""


def within(limits: Limits, axis: PositionerAxis, value: float) -> float:
    """The value, if it may be gone to.

    Raises:
        PositionerError: it is none, or out of the limits.
    """
    if not (math.isfinite(value) and limits.lowest <= value <= limits.highest):
        raise PositionerError(
            f"{value:g} is outside {limits.lowest:g} to {limits.highest:g} {UNITS[axis]}",
            where=axis,
            mend="change the experiment's range, or the positioner's limits if the rig has the room",
        )
    return value
