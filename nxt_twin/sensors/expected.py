"""The expected reading of a sensor, for filters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True)
class Expected:
    """The reading that a model predicts for one truth.

    Attributes:
        mean: in the reading's own unit (cm, raw, 0 to 1), given that there is an echo.
        variance: of the reading round `mean`, its quantisation included.
        p_no_echo: probability that there is no usable reading (255 of the ultrasonic sensor); 0 for others.
    """

    mean: float
    variance: float
    p_no_echo: float
