"""Solve pairs, and hold what is said to have changed against the sealed answers."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, final

from nxt_twin.blind.aims import Aim
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
    """

    name: str
    family: str
    touched: tuple[str, ...]
    verdict: str
    named: tuple[str, ...]
    exact: bool


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


def score_pairs(cases: Path, answers: Path, found: Path) -> list[JudgedPair]:
    """Judge each pair.

    Raises:
        CaseError: an answer is another than was sealed.
    """
    return [
        _judged(read_sealed(answers / f"{folder.name}.json", folder), found / f"{folder.name}.json")
        for folder in case_folders(cases)
    ]


def _judged(answer: Mapping[str, Any], found: Path) -> JudgedPair:
    said = json.loads(found.read_text(encoding="utf-8")) if found.exists() else {}
    verdict = str(said.get("verdict", NO_ANSWER))
    named = tuple(str(change["of"]) for change in said.get("changes", ()))
    touched = tuple(str(change["id"]) for change in answer["changes"])
    right = verdict == ("changed" if touched else "unchanged")
    return JudgedPair(
        str(answer["case"]), str(answer["family"]), touched, verdict, named, right and _names(touched, named)
    )


def _names(touched: Sequence[str], named: Sequence[str]) -> bool:
    """Whether each touch is named, and each name is of one of them or comes with one."""
    touches = [TOUCHES[one] for one in touched]
    allowed = frozenset[str]().union(*(one.names | one.companions for one in touches))
    return all(one.names & set(named) for one in touches) and set(named) <= allowed


def aims_of_pairs(pairs: Sequence[JudgedPair]) -> list[Aim]:
    """The share that is exact, beside what is asked for."""
    found = []
    for words, changes, bound in _AIMS:
        own = [pair.exact for pair in pairs if len(pair.touched) == changes]
        found.append(Aim(words, sum(own) / len(own) if own else None, bound, at_least=True, cases=len(own)))
    return found


def as_lines(pairs: Sequence[JudgedPair]) -> str:
    """The faults, a line each."""
    return "".join(
        f"{pair.name} {pair.family:9} {' + '.join(pair.touched) or 'nothing':34} "
        f"{pair.verdict}: {', '.join(pair.named) or 'nothing'}\n"
        for pair in pairs
        if not pair.exact
    )
