"""The named sets of the proof: which seeds and how many cases of each kind."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Final, final

from nxt_twin.blind.fair import in_fair_order
from nxt_twin.blind.families.family import Family, Order
from nxt_twin.blind.families.orders import Amounts, plan_orders
from nxt_twin.blind.families.table import FAMILIES


@final
@dataclass(frozen=True)
class RangeCase:
    """One case of a range: the seed of its set, and what is to be made."""

    seed: int
    order: Order


@final
@dataclass(frozen=True)
class SeedRange:
    """One named set.

    Attributes:
        name: as it is written after `--range`.
        seeds: one set of each family is made of each seed.
        amounts: of each family and seed; singles are every effect in three sizes.
        most: how many cases are run, the first in the range's order; None is all.
        words: what it is for.
        singles: how many cases with one effect of the library are kept, the first in the range's order; None is all.
    """

    name: str
    seeds: tuple[int, ...]
    amounts: Amounts
    most: int | None
    words: str
    singles: int | None = None

    def cases(self, families: Sequence[Family]) -> list[RangeCase]:
        """The cases in the order in which they are run.

        Every beginning is a fair sample: each family, each kind of case and each size in proportion.
        """
        every = [
            RangeCase(seed, order)
            for seed in self.seeds
            for order in plan_orders(families, seed, self.amounts)
        ]
        singles = in_fair_order([each for each in every if _is_single(each)], _stratum)[: self.singles]
        others = [each for each in every if not _is_single(each)]
        return in_fair_order([*singles, *others], _stratum)[: self.most]


def _stratum(case: RangeCase) -> Hashable:
    """Its kind, size and family."""
    plan = case.order.plan
    return len(plan.effects), _is_stranger(case), plan.size, case.order.family


def _is_single(case: RangeCase) -> bool:
    """Whether it conceals one effect of the library."""
    return len(case.order.plan.effects) == 1 and not _is_stranger(case)


def _is_stranger(case: RangeCase) -> bool:
    """Whether it conceals physics that no library holds."""
    return any(effect in FAMILIES[case.order.family].unknown for effect in case.order.plan.effects)


RANGES: Final[dict[str, SeedRange]] = {
    each.name: each
    for each in (
        SeedRange(
            "sample",
            (901,),
            Amounts(None, 24, 16, 12, 24),
            76,
            "ten minutes; seeds 1 to 999 are for development",
        ),
        SeedRange(
            "development",
            (722,),
            Amounts(None, 6, 6, 0, 6),
            None,
            "the mixture of `third`, smaller, of a seed for development",
            singles=40,
        ),
        SeedRange(
            "scored",
            (5001, 5002),
            Amounts(None, 40, 13, 7, 13),
            None,
            "once a release, looked at by nobody before",
        ),
        SeedRange(
            "silence",
            (5003,),
            Amounts((), 25, 0, 0, 25),
            None,
            "clean motors and unknown effects alone, looked at by nobody before",
        ),
        SeedRange(
            "second",
            (5004,),
            Amounts(None, 25, 6, 0, 25),
            None,
            "the engine after decisions 24 and 25, in half an hour, looked at by nobody before",
            singles=60,
        ),
        SeedRange(
            "third",
            (5005,),
            Amounts(None, 25, 6, 0, 25),
            None,
            "the engine after the work of 25 November 2026, in half an hour, looked at by nobody before",
            singles=60,
        ),
        SeedRange(
            "fourth",
            (5006,),
            Amounts(None, 25, 6, 0, 25),
            None,
            "the engine after decision 31, in half an hour, looked at by nobody before",
            singles=60,
        ),
        SeedRange(
            "release",
            (5007, 5008),
            Amounts(None, 40, 13, 7, 13),
            None,
            "the mixture of `scored` for the engine after decision 32, looked at by nobody before",
        ),
        SeedRange(
            "fifth",
            (5009,),
            Amounts(None, 40, 13, 7, 13),
            None,
            "half of the mixture of `scored` for the engine after decision 33, looked at by nobody before",
        ),
        SeedRange(
            "sixth",
            (5010,),
            Amounts(None, 25, 6, 0, 25),
            None,
            "the engine after the faults that `fifth` showed, in half an hour, looked at by nobody before",
            singles=96,
        ),
        SeedRange(
            "seventh",
            (5011,),
            Amounts(None, 25, 12, 0, 25),
            None,
            "the engine after decision 34, looked at by nobody before",
            singles=200,
        ),
        SeedRange(
            "eighth",
            (5012,),
            Amounts(None, 25, 12, 0, 25),
            None,
            "the engine after decision 35, looked at by nobody before",
            singles=200,
        ),
        SeedRange(
            "ninth",
            (5013, 5014),
            Amounts(None, 38, 13, 7, 13),
            None,
            "the engine after decision 36, looked at by nobody before",
            singles=504,
        ),
        SeedRange(
            "tenth",
            (5015, 5016),
            Amounts(None, 38, 13, 7, 13),
            None,
            "the mixture of `ninth` for the engine after decision 37, looked at by nobody before",
            singles=504,
        ),
        SeedRange(
            "eleventh",
            (5017, 5018),
            Amounts(None, 38, 13, 7, 13),
            None,
            "the mixture of `ninth` for the engine after decision 38, looked at by nobody before",
            singles=504,
        ),
        SeedRange(
            "twelfth",
            (5019, 5020),
            Amounts(None, 38, 13, 7, 13),
            None,
            "the mixture of `ninth` for the engine after decision 39, looked at by nobody before",
            singles=504,
        ),
        SeedRange(
            "thirteenth",
            (5021, 5022),
            Amounts(None, 38, 13, 7, 13),
            None,
            "the mixture of `ninth` for the engine after decision 41, looked at by nobody before",
            singles=504,
        ),
        SeedRange(
            "fourteenth",
            (5023, 5024),
            Amounts(None, 38, 13, 7, 13),
            None,
            "the mixture of `ninth` for the engine after decision 42, looked at by nobody before",
            singles=504,
        ),
        SeedRange(
            "fifteenth",
            (5025, 5026),
            Amounts(None, 38, 13, 7, 13),
            None,
            "the mixture of `ninth` for the engine after decision 48, looked at by nobody before",
            singles=504,
        ),
        SeedRange(
            "sixteenth",
            (5027, 5028),
            Amounts(None, 38, 13, 7, 13),
            None,
            "the mixture of `ninth` for the engine after decision 51, looked at by nobody before",
            singles=504,
        ),
        SeedRange(
            "seventeenth",
            (5029, 5030),
            Amounts(None, 38, 13, 7, 13),
            None,
            "the mixture of `ninth` for the engine after decision 53, looked at by nobody before",
            singles=504,
        ),
    )
}
"""Seeds 1 to 999 are for development; from 5001 on they are scored, and never looked at before."""
