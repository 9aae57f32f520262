"""A whole fleet: find the sessions, diagnose those that are not done, keep each row at once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from typing import final

from nxt_twin.fleet.finding.sessions import session_count, sessions
from nxt_twin.fleet.parcel import Options, Parcel, parcel_of
from nxt_twin.fleet.row import FailureKind, Row, completed, failed
from nxt_twin.fleet.table import FleetTable
from nxt_twin.fleet.version import engine_version
from nxt_twin.fleet.work import diagnosed
from nxt_twin.fleet.workers.each import each
from nxt_twin.fleet.workers.outcome import CaseOutcome, Failure
from nxt_twin.fleet.workers.place import Place


@final
@dataclass(frozen=True)
class FleetTally:
    """How far a fleet is.

    Attributes:
        sessions: of all places.
        kept: whose row an earlier run made.
        diagnosed: with an answer from this run.
        failed: without one.
    """

    sessions: int
    kept: int = 0
    diagnosed: int = 0
    failed: int = 0

    @property
    def ended(self) -> int:
        """How many need no more work."""
        return self.kept + self.diagnosed + self.failed


def diagnose_fleet(
    places: Sequence[str],
    table: FleetTable,
    options: Options,
    place: Place,
    progress: Callable[[FleetTally], None] = lambda _: None,
) -> FleetTally:
    """Diagnose every session that has no row yet.

    Args:
        places: folders, files, globs or URLs.
        table: takes each row as it comes.
        options: of the diagnoses.
        place: where to work.
        progress: told after each session.

    Raises:
        FleetError: there is nothing to diagnose, or nobody to do it; no recording's failure raises.
    """
    return _Run(table, options, progress, FleetTally(session_count(places))).over(places, place)


@final
class _Run:
    def __init__(
        self, table: FleetTable, options: Options, progress: Callable[[FleetTally], None], tally: FleetTally
    ) -> None:
        self._table = table
        self._options = options
        self._progress = progress
        self._tally = tally
        self._done = table.done()

    def over(self, places: Sequence[str], place: Place) -> FleetTally:
        """Do all, and say how it went."""
        with closing(each(diagnosed, self._waiting(places), place)) as outcomes:  # type: ignore[type-var]
            for outcome in outcomes:
                self._keep(_row(outcome))
        return self._tally

    def _waiting(self, places: Sequence[str]) -> Iterator[Parcel]:
        """The cases that have no row, read one by one."""
        for session in sessions(places):
            try:
                parcel = parcel_of(session, self._options)
            except OSError as error:
                row = failed("reading", f"cannot be read: {error.strerror or error}")
                self._keep(completed(row, session.labels, session.source, "", engine_version()))
                continue
            if parcel.key in self._done:
                self._tell(replace(self._tally, kept=self._tally.kept + 1))
            else:
                yield parcel

    def _keep(self, row: Row) -> None:
        self._table.add(row)
        tally = self._tally
        if row["failure"]:
            self._tell(replace(tally, failed=tally.failed + 1))
        else:
            self._tell(replace(tally, diagnosed=tally.diagnosed + 1))

    def _tell(self, tally: FleetTally) -> None:
        self._tally = tally
        self._progress(tally)


def _row(outcome: CaseOutcome[Parcel, Row]) -> Row:
    if outcome.result is not None:
        return outcome.result
    parcel, failure = outcome.task, outcome.failure or Failure("raised", "no answer")
    kind: FailureKind = "worker" if failure.kind == "died" else "program"
    row = failed(kind, failure.text)
    return completed(row, parcel.labels, parcel.source, parcel.key, parcel.engine)
