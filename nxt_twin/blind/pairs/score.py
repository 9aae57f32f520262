"""Solve pairs, and hold what is said to have changed against the sealed answers."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, final

from nxt_twin.blind.aims import Aim
from nxt_twin.blind.pairs.reach import read_reach
from nxt_twin.blind.pairs.touches import TOUCHES
from nxt_twin.blind.solve import case_folders
from nxt_twin.blind.spread import CaseTask, NameAndFailure, spread
from nxt_twin.blind.verdict import NO_ANSWER, read_sealed
from nxt_twin.diagnose.changed.to_json import to_json
from nxt_twin.diagnose.dispatch import changed_since
from nxt_twin.errors import NxtTwinError
from nxt_twin.fleet.workers.place import HERE, Place
from nxt_twin.recording.case import read_case

_AIMS: Final = (
    ("nothing changed: called unchanged", 0, 0.98),
    ("one change: named", 1, 0.90),
    ("two changes: both named", 2, 0.70),
)


@final
@dataclass(frozen=True)
class JudgedPair:
    """One pair, judged.

    Attributes:
        name: of the case.
        family: that made its truth.
        touched: ids of what was done.
        verdict: the answer's, or `none` where there was none.
        named: what the answer says has changed.
        exact: whether everything that was done is named and nothing else.
        detectable: whether the recordings show every change at all; None where nobody fitted the truth.
        holds: whether it is exact, or would be with an alternative in the place of the change that it names.
        set_size: how many things the answer considers: what it names, and alternatives.
    """

    name: str
    family: str
    touched: tuple[str, ...]
    verdict: str
    named: tuple[str, ...]
    exact: bool
    detectable: bool | None = None
    holds: bool = False
    set_size: int = 0


def solve_pairs(folders: Sequence[Path], out: Path, *, place: Place = HERE) -> Iterator[NameAndFailure]:
    """Compare the sides of each pair into `out`; those that have their JSON already are passed over."""
    out.mkdir(parents=True, exist_ok=True)
    waiting = [(folder, out / f"{folder.name}.json") for folder in folders]
    tasks = [task for task in waiting if not task[1].exists()]
    yield from spread((CaseTask(task[0].name, _solve, task) for task in tasks), place)


def _solve(folder: Path, target: Path) -> NameAndFailure:
    try:
        found = changed_since(read_case(folder))
    except NxtTwinError as error:
        return folder.name, str(error)
    target.write_text(to_json(found), encoding="utf-8")
    return folder.name, ""


def score_pairs(cases: Path, answers: Path, found: Path, reached: Path | None = None) -> list[JudgedPair]:
    """Judge each pair.

    Args:
        cases: folder of the pairs.
        answers: folder of the sealed answers.
        found: folder of the answers that were given.
        reached: folder of what the true changes gain (`reach_pairs`), where that is known.

    Raises:
        CaseError: an answer is another than was sealed.
    """
    judged = []
    for folder in case_folders(cases):
        file = f"{folder.name}.json"
        pair = _judged(read_sealed(answers / file, folder), found / file)
        reach = read_reach(reached / file) if reached else None
        judged.append(replace(pair, detectable=reach.is_detectable) if reach else pair)
    return judged


def _judged(answer: Mapping[str, Any], found: Path) -> JudgedPair:
    said = json.loads(found.read_text(encoding="utf-8")) if found.exists() else {}
    verdict = str(said.get("verdict", NO_ANSWER))
    named = tuple(str(change["of"]) for change in said.get("changes", ()))
    touched = tuple(str(change["id"]) for change in answer["changes"])
    others = [(str(one["instead_of"]), str(one["id"])) for one in said.get("alternatives", ())]
    right = verdict == ("changed" if touched else "unchanged")
    exact = right and _names(touched, named)
    sets = (tuple(other if each == place else each for each in named) for place, other in others)
    return JudgedPair(
        str(answer["case"]),
        str(answer["family"]),
        touched,
        verdict,
        named,
        exact,
        holds=exact or (right and any(_names(touched, each) for each in sets)),
        set_size=len(named) + len(others),
    )


def _names(touched: Sequence[str], named: Sequence[str]) -> bool:
    """Whether each touch is named, and each name is of one of them or comes with one."""
    touches = [TOUCHES[one] for one in touched]
    allowed = frozenset[str]().union(*(one.names | one.companions for one in touches))
    return all(one.names & set(named) for one in touches) and set(named) <= allowed


def aims_of_pairs(pairs: Sequence[JudgedPair]) -> list[Aim]:
    """The share that is exact, beside what is asked for: of all pairs, and of those that show their changes."""
    found = []
    for words, changes, bound in _AIMS:
        own = [pair for pair in pairs if len(pair.touched) == changes]
        found.append(_exact(words, own, bound))
        if changes:
            found.append(_share(f"{words}, or an alternative is", [pair.holds for pair in own], bound))
        if changes and any(pair.detectable is not None for pair in own):
            found.append(_exact(f"{words}, detectable", [pair for pair in own if pair.detectable], bound))
    return found


def _exact(words: str, pairs: Sequence[JudgedPair], bound: float) -> Aim:
    return _share(words, [pair.exact for pair in pairs], bound)


def _share(words: str, right: Sequence[bool], bound: float) -> Aim:
    return Aim(words, sum(right) / len(right) if right else None, bound, at_least=True, cases=len(right))


def as_lines(pairs: Sequence[JudgedPair]) -> str:
    """The faults, a line each."""
    return "".join(
        f"{pair.name} {pair.family:9} {' + '.join(pair.touched) or 'nothing':34} "
        f"{pair.verdict}: {', '.join(pair.named) or 'nothing'}{_shown(pair)}\n"
        for pair in pairs
        if not pair.exact
    )


def _shown(pair: JudgedPair) -> str:
    """What a fault's line says of a change that the recordings do not show."""
    return " (not detectable)" if pair.touched and pair.detectable is False else ""
