"""Units among units: from comparisons with a first one to which of them differs in what."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from typing import final

from nxt_twin.diagnose.changed.answer import Change, Changes
from nxt_twin.diagnose.changed.words import change_words, parameter_words
from nxt_twin.diagnose.telling.words import listed
from nxt_twin.diagnose.units import after_number

SCHEMA = "nxt-twin/units/1"
_FEWEST_OTHERS = 2  # that agree, for the first one to be the odd one


@final
@dataclass(frozen=True)
class Among:
    """What several units have in common, and which differs in what.

    Attributes:
        sentence: in words.
        units: names, the first one being what the others were compared with.
        alike: names of those that are as the first one.
        unexplained: names of those that differ in what no few causes explain.
        odd_first: what all others share and the first one has not, by the name of the parameter or effect.
        differs: what each other unit differs in besides, by its name.
    """

    sentence: str
    units: tuple[str, ...]
    alike: tuple[str, ...]
    unexplained: tuple[str, ...]
    odd_first: tuple[str, ...]
    differs: dict[str, tuple[str, ...]]


def among(found: Sequence[Changes]) -> Among:
    """Say which of several units differs in what.

    Args:
        found: comparisons of each other unit with the first one, at least two.
    """
    first = found[0].before
    odd = _odd(found)
    alike = tuple(each.name for each in found if each.verdict == "unchanged")
    strange = tuple(each.name for each in found if each.verdict == "unexplained")
    own = {
        each.name: tuple(change for change in each.changes if change.of not in odd)
        for each in found
        if each.verdict == "changed"
    }
    parts = [_odd_words(first, found, odd)] if odd else []
    parts += [_differ_words(name, changes) for name, changes in own.items() if changes]
    parts += [f"{name} differs from {first} in what no few causes explain" for name in strange]
    if alike and len(alike) == len(found):
        parts = [f"{listed([first, *alike])} are alike"]
    elif alike:
        parts.append(f"{listed(list(alike))} {'is' if len(alike) == 1 else 'are'} as {first}")
    return Among(
        sentence=". ".join(parts) + ".",
        units=(first, *(each.name for each in found)),
        alike=alike,
        unexplained=strange,
        odd_first=odd,
        differs={name: tuple(change.of for change in changes) for name, changes in own.items()},
    )


def to_json(units: Among) -> str:
    """The JSON text."""
    content = {
        "schema": SCHEMA,
        "sentence": units.sentence,
        "units": list(units.units),
        "alike": list(units.alike),
        "unexplained": list(units.unexplained),
        "odd_first": list(units.odd_first),
        "differs": {name: list(changes) for name, changes in units.differs.items()},
    }
    return json.dumps(content, ensure_ascii=False, indent=1)


def _odd(found: Sequence[Changes]) -> tuple[str, ...]:
    """What every other unit differs in by one value: then the first one is another."""
    if len(found) < _FEWEST_OTHERS or any(each.verdict != "changed" for each in found):
        return ()
    by_unit = [{change.of: change for change in each.changes} for each in found]
    shared = [name for name in by_unit[0] if all(name in each for each in by_unit)]
    return tuple(name for name in shared if _agree([each[name] for each in by_unit]))


def _agree(changes: Sequence[Change]) -> bool:
    """Whether all values after may be one."""
    middle = median(change.after for change in changes)
    return all(change.interval_95[0] <= middle <= change.interval_95[1] for change in changes)


def _odd_words(first: str, found: Sequence[Changes], odd: Sequence[str]) -> str:
    told = []
    for name in odd:
        values = [change for each in found for change in each.changes if change.of == name]
        unit = after_number(values[0].unit)
        others = median(change.after for change in values)
        before = values[0].before
        what = parameter_words(name)
        told.append(
            f"all others have {what} that it lacks"
            if before is None
            else f"{what} is {before:.3g}{unit} there and {others:.3g} in all others"
        )
    return f"{first} is the odd one: {listed(told)}"


def _differ_words(name: str, changes: Sequence[Change]) -> str:
    return f"{name} differs in {listed([change_words(change) for change in changes])}"
