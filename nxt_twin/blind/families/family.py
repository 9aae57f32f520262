"""The interface of a truth family."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

from nxt_twin.blind.case import ConcealedCase
from nxt_twin.blind.polling import LinkName
from nxt_twin.blind.sets import CasePlan


@final
@dataclass(frozen=True)
class Order:
    """One case that is wanted.

    Attributes:
        family: the name of the family that makes it.
        plan: what is to be in it.
        link: how a brick is polled, where the family's hosts poll one.
        duration_s: of each recording; None leaves it to the family.
    """

    family: str
    plan: CasePlan
    link: LinkName
    duration_s: float | None


@final
@dataclass(frozen=True)
class Family:
    """One family.

    Attributes:
        name: as it is written after `--family`.
        simulator: what makes its truth, in words.
        known: ids of the contract's effects that it can hide.
        unknown: ids of physics in nobody's library.
        compatible: whether effects of these ids can stand in one case.
        make: makes a case.
        ready: why it cannot be used here; an empty text where it can.
    """

    name: str
    simulator: str
    known: tuple[str, ...]
    unknown: tuple[str, ...]
    compatible: Callable[[tuple[str, ...]], bool]
    make: Callable[[Order], ConcealedCase]
    ready: Callable[[], str]
