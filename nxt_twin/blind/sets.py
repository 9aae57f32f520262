"""Which cases a whole benchmark set holds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.random import Generator

from nxt_twin.blind.effects.library import KNOWN_EFFECTS, UNKNOWN_EFFECTS, compatible
from nxt_twin.blind.kinds import SIZES, Size
from nxt_twin.errors import CaseError

LARGEST_SEED = 2**53


@final
@dataclass(frozen=True)
class CasePlan:
    """One case to be made; `size` None draws a size for each effect."""

    name: str
    seed: int
    effects: tuple[str, ...]
    size: Size | None


def plan_set(
    seed: int,
    *,
    effects: tuple[str, ...] = tuple(KNOWN_EFFECTS),
    sizes: tuple[Size, ...] = SIZES,
    clean: int = 40,
    pairs: int = 30,
    triples: int = 10,
    unknown: int = 10,
    strangers: tuple[str, ...] = tuple(UNKNOWN_EFFECTS),
    together: Callable[[tuple[str, ...]], bool] = compatible,
    prefix: str = "case",
) -> tuple[CasePlan, ...]:
    """Plan a set: each effect alone in each size, and the given numbers of clean, double, triple and unknown cases.

    Pairs and triples are drawn from `effects` that may stand `together`, unknown ones in turn from `strangers`,
    which no library holds. The order is shuffled and the names are numbers behind `prefix`, so that neither tells
    what is in a case.

    Raises:
        CaseError: where pairs or triples are wanted, and too few of `effects` may stand together.
    """
    rng = np.random.default_rng(seed)
    contents: list[tuple[tuple[str, ...], Size | None]] = [
        ((effect,), size) for effect in effects for size in sizes
    ]
    contents += [((), None)] * clean
    contents += [(_together(rng, effects, 2, together), None) for _ in range(pairs)]
    contents += [(_together(rng, effects, 3, together), None) for _ in range(triples)]
    in_turn = [str(name) for name in rng.permutation(list(strangers))]
    contents += [((in_turn[index % len(in_turn)],), None) for index in range(unknown)]
    order = rng.permutation(len(contents))
    return tuple(
        CasePlan(f"{prefix}-{number:04d}", int(rng.integers(LARGEST_SEED)), *contents[index])
        for number, index in enumerate(order, start=1)
    )


def _together(
    rng: Generator, effects: tuple[str, ...], count: int, together: Callable[[tuple[str, ...]], bool]
) -> tuple[str, ...]:
    """Draw effects that can stand in one case."""
    chosen: tuple[str, ...] = ()
    for effect in rng.permutation(list(effects)):
        if len(chosen) < count and together((*chosen, str(effect))):
            chosen = (*chosen, str(effect))
    if len(chosen) < count:
        kind = "pairs" if count == 2 else "triples"
        those = (
            f"the effects {', '.join(effects)} hold no {count} that stand together"
            if effects
            else "no effects"
        )
        raise CaseError(f"no {kind} can be made: {those}", mend=f"name more effects, or give --{kind} 0")
    return chosen
