"""The record of the errors that the true structure reached on a case."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, final


@final
@dataclass(frozen=True)
class Reach:
    """Gain and error of the library with exactly the hidden effects, fitted from their true sizes.

    Attributes:
        gain_nats: by which it beats the re-fitted baseline on the readings that are fitted (BIC).
        check_nats: that gain on the check readings.
        held_out_rmse: its free-run error on what nobody fitted, in the diagnosis's unit.
        horizons: that error by the length of the simulated windows, s; inf is a whole recording.
        each_gain_nats: by effect, what it gains beside the other hidden ones (BIC); empty where it is alone.
    """

    gain_nats: float
    check_nats: float
    held_out_rmse: float
    horizons: Mapping[float, float] = field(default_factory=dict)
    each_gain_nats: Mapping[str, float] = field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        """The reach as JSON values; a whole recording is null."""
        own = [[None if math.isinf(seconds) else seconds, rmse] for seconds, rmse in self.horizons.items()]
        return {**vars(self), "horizons": own, "each_gain_nats": dict(self.each_gain_nats)}


def reached(held: Mapping[str, Any]) -> Reach:
    """Read a reach as it was written."""
    return Reach(
        float(held["gain_nats"]),
        float(held["check_nats"]),
        float(held["held_out_rmse"]),
        {seconds_of(seconds): float(rmse) for seconds, rmse in held.get("horizons", [])},
        {name: float(nats) for name, nats in held.get("each_gain_nats", {}).items()},
    )


def seconds_of(seconds: float | None) -> float:
    """A horizon as JSON has it: null is a whole recording."""
    return math.inf if seconds is None else float(seconds)
