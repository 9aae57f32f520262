"""Run a named range case by case, in an order of which every beginning is a fair sample; what is there is kept."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, final

from nxt_twin.blind.families.family import Family
from nxt_twin.blind.limits_in_turn import Recorded
from nxt_twin.blind.peers.answers import PEERS
from nxt_twin.blind.peers.localised import ChosenCells
from nxt_twin.blind.prove import DELETION, ReadClock, Shelf, delete, is_deleted, prove
from nxt_twin.blind.ranges import RangeCase, SeedRange
from nxt_twin.blind.score import judged_case
from nxt_twin.blind.solve import record_file
from nxt_twin.blind.spread import CaseTask, CaseWork, NameAndFailure, spread
from nxt_twin.blind.told import Deleted
from nxt_twin.blind.verdict import NO_ANSWER, Judged
from nxt_twin.diagnose.judging.verdict import Record
from nxt_twin.fleet.workers.place import Place


@final
@dataclass(frozen=True)
class FinishedCase:
    """A case of which everything was tried.

    Attributes:
        case: which.
        engine: which engine answered.
        seconds: processor time by step.
        failed: steps that gave no answer, and why.
    """

    case: RangeCase
    engine: str
    seconds: dict[str, float]
    failed: tuple[str, ...]


@final
@dataclass(frozen=True)
class Proof:
    """Where a range is kept, and what is known of it.

    Attributes:
        folder: holds one folder a seed.
        chosen: the range.
        families: of the truth.
        most: no more cases than these, the first of the range's order; None is all of the range.
    """

    folder: Path
    chosen: SeedRange
    families: tuple[Family, ...]
    most: int | None = None

    @cached_property
    def cases(self) -> list[RangeCase]:
        """All cases, in the order in which they are run."""
        return self.chosen.cases(self.families)[: self.most]

    def waiting(self) -> list[RangeCase]:
        """Those that are not finished."""
        return [case for case in self.cases if not self._file(case).exists()]

    def run(
        self, place: Place, clock: ReadClock, goes_on: Callable[[], bool], *, peers: bool
    ) -> Iterator[NameAndFailure]:
        """Do the cases that wait, as long as it `goes_on`; cases that have begun are ended. Yields their outcomes."""
        tasks = [(case, self._shelf(case), clock, peers) for case in self.waiting()]
        yield from spread(_begun(prove, tasks, goes_on), place)

    def undeleted(self) -> list[RangeCase]:
        """The finished cases of the first seed that are to be diagnosed once more without their effect."""
        own = [one for one in self.finished() if one.case.seed == self.chosen.seeds[0]]
        own = [one for one in own if not any(why.startswith(DELETION) for why in one.failed)]
        return [
            one.case
            for one in own
            if (shelf := self._shelf(one.case))
            and (name := one.case.order.plan.name)
            and not shelf.file("deleted", name).exists()
            and is_deleted(shelf.judged(name))
        ]

    def delete(self, place: Place, clock: ReadClock, goes_on: Callable[[], bool]) -> Iterator[NameAndFailure]:
        """Diagnose those without their effect, as `run` does the others."""
        tasks = [(case, self._shelf(case), clock) for case in self.undeleted()]
        yield from spread(_begun(delete, tasks, goes_on), place)

    def finished(self) -> list[FinishedCase]:
        """The cases of which everything was tried."""
        found = []
        for case in self.cases:
            if (file := self._file(case)).exists():
                held = json.loads(file.read_text(encoding="utf-8"))
                found.append(FinishedCase(case, held["engine"], held["seconds"], tuple(held["failed"])))
        return found

    def judged(self) -> list[Judged]:
        """Each finished case, judged."""
        return [self._shelf(one.case).judged(one.case.order.plan.name) for one in self.finished()]

    def recorded(self) -> list[Recorded]:
        """Each finished case beside which the numbers of its verdict lie."""
        found = []
        for one in self.finished():
            shelf, name = self._shelf(one.case), one.case.order.plan.name
            if (file := record_file(shelf.file("diagnoses", name))).exists():
                record = Record(**json.loads(file.read_text(encoding="utf-8")))
                found.append(Recorded(shelf.judged(name), record))
        return found

    def answers(self) -> list[tuple[str, Mapping[str, Any]]]:
        """The diagnosis of each finished case that has one, as JSON values, beside the family of its truth."""
        files = [
            (one.case.order.family, self._shelf(one.case).file("diagnoses", one.case.order.plan.name))
            for one in self.finished()
        ]
        return [
            (family, json.loads(file.read_text(encoding="utf-8"))) for family, file in files if file.exists()
        ]

    def deletions(self) -> dict[str, list[Deleted]]:
        """The cases whose effect was taken out, by effect."""
        found: dict[str, list[Deleted]] = {}
        for one in self.finished():
            shelf, name = self._shelf(one.case), one.case.order.plan.name
            if (file := shelf.file("deleted", name)).exists():
                hidden = json.loads(shelf.file("answers", name).read_text(encoding="utf-8"))["effects"]
                answer = json.loads(file.read_text(encoding="utf-8"))
                names = tuple(str(one["id"]) for one in answer["effects"])
                found.setdefault(str(hidden[0]["id"]), []).append(Deleted(str(answer["verdict"]), names))
        return found

    def peers(self) -> dict[str, list[Judged]]:
        """Each other method's answers, judged, where it answered all finished cases."""
        found: dict[str, list[Judged]] = {}
        for peer in PEERS:
            answered = [
                judged_case(
                    shelf.file("answers", name), shelf.of("cases"), shelf.of("peers") / peer.name, None
                )
                for one in self.finished()
                if (shelf := self._shelf(one.case)) and (name := one.case.order.plan.name)
            ]
            found[peer.name] = [case for case in answered if case.verdict != NO_ANSWER]
        return found

    def cells(self) -> list[ChosenCells]:
        """Where each method sees a model that is wrong, of each finished case of which a regression tells the truth."""
        files = [self._shelf(one.case).file("localised", one.case.order.plan.name) for one in self.finished()]
        return [json.loads(file.read_text(encoding="utf-8")) for file in files if file.exists()]

    def _shelf(self, case: RangeCase) -> Shelf:
        return Shelf(self.folder.resolve() / str(case.seed))

    def _file(self, case: RangeCase) -> Path:
        return self._shelf(case).file("finished", case.order.plan.name)


def _begun(
    work: CaseWork, tasks: Iterable[tuple[Any, ...]], goes_on: Callable[[], bool]
) -> Iterator[CaseTask]:
    """What is to be done with each case, which comes first in its task, as long as it `goes_on`."""
    for task in tasks:
        if not goes_on():
            return
        yield CaseTask(task[0].order.plan.name, work, task)
