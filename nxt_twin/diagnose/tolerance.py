"""An error that does not matter, as a person writes it: `2deg`, `0.5mm`."""

from __future__ import annotations

import math
import re
from typing import Final

from nxt_twin.errors import DiagnosisError

_SI: Final = {
    "deg": math.radians(1.0),
    "rad": 1.0,
    "mm": 1e-3,
    "cm": 1e-2,
    "m": 1.0,
    "deg/s": math.radians(1.0),
    "rad/s": 1.0,
    "mm/s": 1e-3,
    "m/s": 1.0,
}
_WRITTEN: Final = re.compile(r"\s*([0-9]*\.?[0-9]+(?:[eE][-+]?[0-9]{1,2})?)\s*([a-z/]+)\s*")


_LENGTHS: Final = ("mm", "cm", "m")


def is_length(text: str) -> bool:
    """Whether a tolerance is one of a position in m."""
    found = _WRITTEN.fullmatch(text[:40])
    return found is not None and found.group(2) in _LENGTHS


def parse_tolerance(text: str) -> float:
    """The tolerance in SI units (rad, m, or per second).

    Args:
        text: a positive number and a unit of the readings.

    Raises:
        DiagnosisError: the text is no such thing.
    """
    found = _WRITTEN.fullmatch(text[:40])
    if found is None or found.group(2) not in _SI or not float(found.group(1)) > 0.0:
        raise DiagnosisError(
            f"{text[:40]!r} is no tolerance",
            where="--tolerance",
            mend=f"write 2deg; units are {', '.join(_SI)}",
        )
    return float(found.group(1)) * _SI[found.group(2)]
