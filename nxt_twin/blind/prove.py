"""One case of the proof, from its making to its last answer; files that are there already are kept."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Final, Literal, final

from nxt_twin.blind.aims import is_detectable
from nxt_twin.blind.families.orders import make_one
from nxt_twin.blind.peers.answers import answer_one, folders_of_peers
from nxt_twin.blind.peers.localised import OURS, localise_one
from nxt_twin.blind.ranges import RangeCase
from nxt_twin.blind.score import judged_case
from nxt_twin.blind.solve import reach_one, solve_one
from nxt_twin.blind.spread import NameAndFailure
from nxt_twin.blind.verdict import Judged
from nxt_twin.blind.whole import write_whole
from nxt_twin.fleet.version import engine_version

ReadClock = Callable[[], float]
"""Processor time of the process that asks, s."""
DELETION: Final = "diagnose without the effect"
"""The step that comes last, once all cases have their answers."""
Step = tuple[str, Callable[[], NameAndFailure]]

_CONTAINED_IN: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "gravity_load": ("hanging_payload",),
        "payload_inertia": ("hanging_payload",),
        "hanging_payload": ("gravity_load", "payload_inertia"),
        "coulomb_friction": ("asymmetric_friction",),
        "viscous_friction": ("asymmetric_viscous_friction",),
    }
)
"""Effects that hold the physics of another, or its parts: they go with it."""


def taken_out(effect: str) -> frozenset[str]:
    """What leaves the library so that nobody knows an effect's physics."""
    return frozenset((effect, *_CONTAINED_IN.get(effect, ())))


@final
@dataclass(frozen=True)
class Shelf:
    """The folders of one seed; answers lie apart from cases."""

    root: Path

    def of(
        self,
        part: Literal[
            "cases", "answers", "diagnoses", "reached", "deleted", "peers", "localised", "finished"
        ],
    ) -> Path:
        """The folder of one kind of file."""
        return self.root / part

    def localise(self, case: str) -> NameAndFailure:
        """Say of each method in which regimes of the case it sees a model that is wrong."""
        answers = {OURS: self.of("diagnoses"), **folders_of_peers(self.of("peers"))}
        return localise_one(
            self.of("cases") / case, self.file("answers", case), answers, self.of("localised")
        )

    def file(
        self, part: Literal["answers", "diagnoses", "reached", "deleted", "localised", "finished"], case: str
    ) -> Path:
        """The file of one case."""
        return self.of(part) / f"{case}.json"

    def judged(self, case: str) -> Judged:
        """The case as its diagnosis is judged; a diagnosis that is not there counts as no answer."""
        return judged_case(
            self.file("answers", case), self.of("cases"), self.of("diagnoses"), self.of("reached")
        )


def is_deleted(case: Judged) -> bool:
    """Whether the case is diagnosed once more without its effect: one that could be found and is not small."""
    return case.kind == "single" and case.sizes[0] != "small" and is_detectable(case)


def prove(case: RangeCase, shelf: Shelf, clock: ReadClock, peers: bool) -> NameAndFailure:
    """Make the case, diagnose it, fit its truth, and let others answer; `finished` says that all was tried.

    A step that fails leaves no file: the case has no answer there, and the proof goes on. A case that cannot be made
    is not finished.
    """
    return _tried(case.order.plan.name, _steps(case, shelf, peers=peers), shelf, clock)


def delete(case: RangeCase, shelf: Shelf, clock: ReadClock) -> NameAndFailure:
    """Diagnose a finished case once more, without its effect in the library; `finished` says that this was tried."""
    name = case.order.plan.name
    without = taken_out(shelf.judged(name).hidden[0])
    target = shelf.file("deleted", name)
    step = (DELETION, lambda: solve_one(shelf.of("cases") / name, target, 0, without))
    return _tried(name, [step], shelf, clock)


def _tried(name: str, steps: Iterable[Step], shelf: Shelf, clock: ReadClock) -> NameAndFailure:
    """Do one step after the other, and add to `finished` how long each took and what failed."""
    file = shelf.file("finished", name)
    before = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {"seconds": {}, "failed": []}
    seconds: dict[str, float] = {}
    failed: list[str] = []
    for step, work in steps:
        began = clock()
        why = _why(work)
        seconds[step] = clock() - began
        if why:
            failed.append(f"{step}: {why}")
        if why and step == "make":
            return name, failed[0]
    engines = dict.fromkeys([before.get("engine", engine_version()), engine_version()])
    held = {
        "engine": " and ".join(engines),
        "seconds": {**before["seconds"], **seconds},
        "failed": [*before["failed"], *failed],
    }
    write_whole(file, json.dumps(held))
    return name, "; ".join(failed)


def _steps(case: RangeCase, shelf: Shelf, *, peers: bool) -> Iterator[Step]:
    """Each step that is not done yet, when those before it are."""
    name = case.order.plan.name
    folder = shelf.of("cases") / name
    yield "make", lambda: make_one(case.order, shelf.of("cases"), shelf.of("answers"))
    diagnosis, reached = shelf.file("diagnoses", name), shelf.file("reached", name)
    if not diagnosis.exists():
        yield "diagnose", lambda: solve_one(folder, diagnosis, 0, frozenset())
    if not reached.exists():
        yield "fit the truth", lambda: reach_one(folder, reached, shelf.file("answers", name))
    if peers:
        yield "let others answer", lambda: answer_one(folder, shelf.of("peers"))
        yield "localise", lambda: shelf.localise(name)


def _why(work: Callable[[], NameAndFailure]) -> str:
    """Why a step failed, whatever it raised; empty where it did not."""
    try:
        return work()[1]
    except Exception as error:
        return f"{type(error).__name__}: {' '.join(str(error).split())}"
