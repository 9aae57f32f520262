"""The named sets of the proof: which seeds and how many cases of each kind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from nxt_twin.blind.families.family import Family, Order
from nxt_twin.blind.families.orders import Amounts, plan_orders


@final
@dataclass(frozen=True)
class SeedRange:
    """One named set.

    Attributes:
        name: as it is written after `--range`.
        seeds: one set of each family is made of each seed.
        amounts: of each family and seed; singles are every effect in three sizes.
        most: no more than so many cases of each family and seed, those that come first in a shuffled order.
        words: what it is for.
    """

    name: str
    seeds: tuple[int, ...]
    amounts: Amounts
    most: int | None
    words: str

    def orders(self, families: Sequence[Family]) -> dict[int, tuple[Order, ...]]:
        """What is to be made, by seed."""
        return {seed: self._of(families, seed) for seed in self.seeds}

    def _of(self, families: Sequence[Family], seed: int) -> tuple[Order, ...]:
        every = plan_orders(families, seed, self.amounts)
        kept: list[Order] = []
        for family in families:
            kept += [order for order in every if order.family == family.name][: self.most]
        return tuple(kept)


RANGES: Final[dict[str, SeedRange]] = {
    each.name: each
    for each in (
        SeedRange(
            "sample",
            (901,),
            Amounts(None, 24, 16, 8, 24),
            10,
            "ten minutes; seeds 1 to 999 are for development",
        ),
        SeedRange(
            "scored",
            (5001, 5002),
            Amounts(None, 40, 13, 7, 13),
            None,
            "once a release, looked at by nobody before",
        ),
    )
}
"""Seeds 1 to 999 are for development; from 5001 on they are scored, and never looked at before."""
