"""Diagnose the cases of a folder, and reach for the truth of each, wherever there is somebody to do it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from types import MappingProxyType

from nxt_twin.blind.reach import reach
from nxt_twin.blind.spread import CaseTask, NameAndFailure, spread
from nxt_twin.blind.verdict import read_sealed
from nxt_twin.blind.whole import write_whole
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.diagnose.telling.to_json import to_json
from nxt_twin.errors import NxtTwinError
from nxt_twin.fleet.workers.place import Place
from nxt_twin.recording.case import read_case


def case_folders(cases: Path) -> list[Path]:
    """The folders in `cases` that are cases."""
    return sorted(folder for folder in cases.iterdir() if (folder / "case.yaml").exists())


def solve_all(
    folders: Sequence[Path],
    out: Path,
    *,
    seed: int,
    place: Place,
    without: Mapping[str, frozenset[str]] = MappingProxyType({}),
) -> Iterator[NameAndFailure]:
    """Diagnose each case into `out`; those that have their JSON already are passed over.

    `without` holds, by a case's name, ids of effects that its diagnosis may not try.
    """
    out.mkdir(parents=True, exist_ok=True)
    waiting = [folder for folder in folders if not _file(out, folder).exists()]
    # Workers of a cluster have folders of their own to start from.
    waiting = [folder.resolve() for folder in waiting]
    tasks = [
        (folder, _file(out.resolve(), folder), seed, without.get(folder.name, frozenset()))
        for folder in waiting
    ]
    yield from spread((CaseTask(task[0].name, solve_one, task) for task in tasks), place)


def reach_all(folders: Sequence[Path], answers: Path, out: Path, *, place: Place) -> Iterator[NameAndFailure]:
    """Write what the true structure reaches on each case into `out`; what is there is passed over."""
    out.mkdir(parents=True, exist_ok=True)
    waiting = [folder for folder in folders if not _file(out, folder).exists()]
    waiting = [folder.resolve() for folder in waiting]
    tasks = [(folder, _file(out.resolve(), folder), _file(answers.resolve(), folder)) for folder in waiting]
    yield from spread((CaseTask(task[0].name, reach_one, task) for task in tasks), place)


def _file(folder: Path, case: Path) -> Path:
    """The file of a case in a folder of answers."""
    return folder / f"{case.name}.json"


def solve_one(folder: Path, target: Path, seed: int, without: frozenset[str]) -> NameAndFailure:
    """Diagnose one case without some effects, and write the diagnosis as JSON to `target`.

    The numbers that its verdict rests on go beside it (`record_file`): other limits can be tried on them.
    """
    try:
        answer = diagnose(read_case(folder), seed=seed, without=without)
    except NxtTwinError as error:
        return folder.name, str(error)
    if answer.record is not None:
        write_whole(
            record_file(target), json.dumps(asdict(answer.record), default=lambda number: number.item())
        )
    write_whole(target, to_json(answer.diagnosis))
    return folder.name, ""


def record_file(diagnosis: Path) -> Path:
    """Where the record of a verdict lies, beside its diagnosis."""
    return diagnosis.with_suffix(".record.json")


def reach_one(folder: Path, target: Path, answer_file: Path) -> NameAndFailure:
    """Fit the sealed answer's structure to one case, and write what it reaches to `target`."""
    try:
        found = reach(read_case(folder), read_sealed(answer_file, folder))
    except NxtTwinError as error:
        return folder.name, str(error)
    write_whole(target, json.dumps(None if found is None else found.as_dict()))
    return folder.name, ""
