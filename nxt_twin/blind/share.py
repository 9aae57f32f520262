"""A share: a count of a total, and how sure it is."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Final, final

NORMAL_95: Final = 1.959964


@final
@dataclass(frozen=True)
class Share:
    """`count` of `of` cases, with Wilson's 95 % interval; an empty share spans 0 to 1."""

    count: int
    of: int

    @property
    def interval(self) -> tuple[float, float]:
        """Wilson's score interval, 95 %."""
        if self.of == 0:
            return 0.0, 1.0
        share, z2 = self.count / self.of, NORMAL_95**2
        middle = (share + z2 / (2 * self.of)) / (1.0 + z2 / self.of)
        spread = math.sqrt(share * (1.0 - share) / self.of + z2 / (4 * self.of**2))
        half = NORMAL_95 * spread / (1.0 + z2 / self.of)
        return max(0.0, middle - half), min(1.0, middle + half)

    def __str__(self) -> str:
        low, high = self.interval
        return f"{self.count}/{self.of} [{100 * low:.0f}–{100 * high:.0f} %]"

    def as_dict(self) -> dict[str, Any]:
        """The share as JSON values."""
        return {
            "count": self.count,
            "of": self.of,
            "wilson_95": [round(bound, 4) for bound in self.interval],
        }


def share_of(told: Iterable[bool | None]) -> Share:
    """How many hold, of those of which it is known."""
    known = [one for one in told if one is not None]
    return Share(sum(known), len(known))
