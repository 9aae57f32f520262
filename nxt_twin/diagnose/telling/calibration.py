"""Probabilities as they are told: the share of belief among what was weighed, less the chance of something else."""

from __future__ import annotations

from typing import Final

UNCONSIDERED: Final = 0.08
"""How often the cause of a mismatch that was explained is nothing that was weighed.

It may be physics of nobody's library, or a structure in which the search got caught. Set on seed 700 of the four truth
families, where a third of the cases is unknown physics: 84 of 91 names were right (docs/proof.md#calibration).
"""

LEFT_OUT: Final = 0.5
"""The probability of an effect that readings call for, and that an answer leaves out as no simulation needs it.

Such an effect was there in 12 of 22 `adequate` answers that told any. They are of the ranges `seventh` and `eighth`,
spent by then, where a quarter of the cases hides unknown physics.
"""


def told_probability(share: float) -> float:
    """The probability of what holds this `share` of the belief among all that was weighed."""
    return (1.0 - UNCONSIDERED) * share
