"""Make what is ordered of several families, wherever there is somebody to do it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import final

import numpy as np

from nxt_twin.blind.case import SEAL_FILE
from nxt_twin.blind.families.family import Family, Order
from nxt_twin.blind.families.table import BRISTLE, FAMILIES
from nxt_twin.blind.make import write_case
from nxt_twin.blind.polling import LinkName
from nxt_twin.blind.sets import plan_set
from nxt_twin.blind.spread import CaseTask, NameAndFailure, spread
from nxt_twin.errors import CaseError, NxtTwinError
from nxt_twin.fleet.workers.place import HERE, Place


@final
@dataclass(frozen=True)
class Amounts:
    """How many cases of each kind a set holds for each of its families; `effects` None takes all in three sizes."""

    effects: tuple[str, ...] | None = None
    clean: int = 40
    pairs: int = 30
    triples: int = 10
    unknown: int = 10


def families_of(names: Sequence[str]) -> tuple[Family, ...]:
    """The families of these names.

    Raises:
        CaseError: for a name that is none, or a family that cannot be used here.
    """
    for name in names:
        if name not in FAMILIES:
            raise CaseError(f"no family {name!r}", mend=f"choose from {', '.join(FAMILIES)}")
        if why := FAMILIES[name].ready():
            raise CaseError(
                f"the family {name} cannot be made here: {why}", mend="pip install 'nxt-twin[proof]'"
            )
    return tuple(FAMILIES[name] for name in names)


def plan_orders(
    families: Sequence[Family],
    seed: int,
    amounts: Amounts,
    *,
    links: Sequence[LinkName] = ("usb", "bluetooth"),
    duration_s: float | None = None,
) -> tuple[Order, ...]:
    """Plan a number of cases for each family; of the effects that are asked for, each takes those that it can hide.

    Raises:
        CaseError: for an effect that none of them can hide.
    """
    for effect in amounts.effects or ():
        if not any(effect in family.known + family.unknown for family in families):
            mend = f"choose from {', '.join(sorted({one for family in families for one in family.known}))}"
            raise CaseError(f"no effect {effect!r} to hide", mend=mend)
    orders: list[Order] = []
    for family in families:
        home = family.name == BRISTLE
        asked = family.known if amounts.effects is None else amounts.effects
        plans = plan_set(
            seed if home else _seed_of(seed, family.name),
            effects=tuple(one for one in asked if one in family.known + family.unknown),
            clean=amounts.clean,
            pairs=amounts.pairs,
            triples=amounts.triples,
            unknown=amounts.unknown,
            strangers=family.unknown,
            together=family.compatible,
            prefix="case" if home else family.name,
        )
        orders += [
            Order(family.name, plan, links[k % len(links)], duration_s) for k, plan in enumerate(plans)
        ]
    return tuple(orders)


def _seed_of(seed: int, family: str) -> int:
    words = [seed, *family.encode()]
    return int(np.random.SeedSequence(words).generate_state(1, np.uint64)[0] >> 11)


def make_orders(
    orders: Sequence[Order], cases: Path, answers: Path, *, place: Place = HERE
) -> Iterator[NameAndFailure]:
    """Make and write each case that is not there yet, and yield its name and why it failed, if it did."""
    waiting = [order for order in orders if not _is_made(order, cases)]
    tasks = (
        CaseTask(order.plan.name, make_one, (order, cases.resolve(), answers.resolve())) for order in waiting
    )
    yield from spread(tasks, place)


def make_one(order: Order, cases: Path, answers: Path) -> NameAndFailure:
    """Make and write one case where it is not there yet: its name, and why it failed, if it did."""
    if _is_made(order, cases):
        return order.plan.name, ""
    try:
        write_case(FAMILIES[order.family].make(order), cases, answers)
    except NxtTwinError as error:
        return order.plan.name, str(error)
    return order.plan.name, ""


def _is_made(order: Order, cases: Path) -> bool:
    """Whether the case is whole: its seal is written last."""
    return (cases / order.plan.name / SEAL_FILE).exists()
