"""What the true structure reached on a case, as it is kept."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final


@final
@dataclass(frozen=True)
class Reach:
    """What the library reaches with exactly the effects that are hidden, fitted from their true sizes.

    Attributes:
        gain_nats: by which it beats the re-fitted baseline on the readings that are fitted (BIC).
        check_nats: the same on the readings that only check.
        held_out_rmse: its free-run error on what nobody fitted, in the diagnosis's unit.
    """

    gain_nats: float
    check_nats: float
    held_out_rmse: float


def reached(held: Mapping[str, Any]) -> Reach:
    """Read a reach as it was written."""
    return Reach(**{key: float(held[key]) for key in Reach.__dataclass_fields__})
