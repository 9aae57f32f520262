"""Probabilities as they are told: the share of belief among what was weighed, less the chance of something else."""

from __future__ import annotations

from typing import Final

UNCONSIDERED: Final = 0.05
"""How often the cause of a mismatch that was explained is nothing that was weighed.

It may be physics of nobody's library, or a structure in which the search got caught. About one name of twenty was
wrong, however far behind its rivals lay (development seeds 44, 45, 47, 53, 310 and 901; docs/proof.md#calibration).
"""


def told_probability(share: float) -> float:
    """The probability of what holds this `share` of the belief among all that was weighed."""
    return (1.0 - UNCONSIDERED) * share
