"""The readings of the source paper's tables III to VI: eight touch sensors, eight switchings of each.

Source: Gonçalves et al., section III.B. The means and deviations that are printed beside them stand with the paper.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from nxt_twin.arrays import FloatArray


def _rows(*rows: str) -> FloatArray:
    """Rows of eight readings; `a*n` stands for n readings of a."""
    table = []
    for row in rows:
        cells: list[float] = []
        for word in row.split():
            value, _, times = word.partition("*")
            cells += [float(value)] * int(times or 1)
        table.append(cells)
    samples = np.array(table)
    samples.flags.writeable = False
    return samples


PRESS_FORCE_G: Final = _rows(
    "57*8",
    "62*2 63*6",
    "71*8",
    "66 67*7",
    "62*4 63 62 63 62",
    "71*8",
    "50 49 49 50 49 50*3",
    "52*5 53 52*2",
)
"""Table III: force off to on, g."""

RELEASE_FORCE_G: Final = _rows(
    "53*8", "60*8", "67*7 68", "66*8", "58*6 57 58", "67*7 68", "48*2 46 48*5", "52*8"
)
"""Table IV: force on to off, g."""

PRESS_TRAVEL_MM: Final = _rows(
    "2.11*8", "2.22*8", "2.22*8", "2.02*8", "2.11*8", "2.22*8", "2.00*8", "2.21*4 2.31 2.21*3"
)
"""Table V: travel off to on, mm."""

RELEASE_TRAVEL_MM: Final = _rows(
    "1.80*8", "2.01*8", "1.91*8", "1.81*8", "1.80*8", "2.02 2.00*5 1.91 2.00", "1.70*8", "2.00*8"
)
"""Table VI: travel on to off, mm."""
