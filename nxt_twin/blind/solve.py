"""Diagnose the cases of a folder, and reach for the truth of each, on several processes."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from multiprocessing import get_context
from pathlib import Path
from types import MappingProxyType

from nxt_twin.blind.reach import reach
from nxt_twin.blind.verdict import read_sealed
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.diagnose.telling.to_json import to_json
from nxt_twin.errors import NxtTwinError
from nxt_twin.recording.case import read_case

Outcome = tuple[str, str]
"""A case's name, and why it failed: empty where it did not."""


def case_folders(cases: Path) -> list[Path]:
    """The folders in `cases` that are cases."""
    return sorted(folder for folder in cases.iterdir() if (folder / "case.yaml").exists())


def solve_all(
    folders: Sequence[Path],
    out: Path,
    *,
    seed: int,
    jobs: int,
    without: Mapping[str, frozenset[str]] = MappingProxyType({}),
) -> Iterator[Outcome]:
    """Diagnose each case into `out`; those that have their JSON already are passed over.

    `without` holds, by a case's name, ids of effects that its diagnosis may not try.
    """
    out.mkdir(parents=True, exist_ok=True)
    waiting = [
        (folder, out / f"{folder.name}.json", seed, without.get(folder.name, frozenset()))
        for folder in folders
    ]
    yield from _each(_solve, [task for task in waiting if not task[1].exists()], jobs)


def reach_all(folders: Sequence[Path], answers: Path, out: Path, *, jobs: int) -> Iterator[Outcome]:
    """Write what the true structure reaches on each case into `out`; what is there is passed over."""
    out.mkdir(parents=True, exist_ok=True)
    waiting = [(folder, out / f"{folder.name}.json", answers / f"{folder.name}.json") for folder in folders]
    yield from _each(_reach, [task for task in waiting if not task[1].exists()], jobs)


def _each(work: Callable[..., Outcome], tasks: Sequence[tuple[object, ...]], jobs: int) -> Iterator[Outcome]:
    if jobs == 1:
        yield from (work(*task) for task in tasks)
        return
    # Compiled kernels and threads do not survive a fork.
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        for done in as_completed([pool.submit(work, *task) for task in tasks]):
            yield done.result()


def _solve(folder: Path, target: Path, seed: int, without: frozenset[str]) -> Outcome:
    try:
        answer = diagnose(read_case(folder), seed=seed, without=without)
    except NxtTwinError as error:
        return folder.name, str(error)
    target.write_text(to_json(answer.diagnosis), encoding="utf-8")
    return folder.name, ""


def _reach(folder: Path, target: Path, answer_file: Path) -> Outcome:
    try:
        found = reach(read_case(folder), read_sealed(answer_file, folder))
    except NxtTwinError as error:
        return folder.name, str(error)
    target.write_text(json.dumps(None if found is None else asdict(found)), encoding="utf-8")
    return folder.name, ""
