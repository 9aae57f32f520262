"""An order of cases of which every beginning is a fair sample."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import TypeVar

CaseT = TypeVar("CaseT")


def in_fair_order(cases: Sequence[CaseT], stratum: Callable[[CaseT], Hashable]) -> list[CaseT]:
    """Sort cases so that each beginning holds about as large a share of every stratum.

    The cases of one stratum keep their order, and are spread evenly over the whole. Strata with equal numbers
    of cases take turns in the order of their first cases.
    """
    members: dict[Hashable, list[int]] = {}
    for index, case in enumerate(cases):
        members.setdefault(stratum(case), []).append(index)
    places = {
        index: ((rank + 0.5) / len(own), turn)
        for turn, own in enumerate(members.values())
        for rank, index in enumerate(own)
    }
    return [cases[index] for index in sorted(places, key=lambda index: places[index])]
