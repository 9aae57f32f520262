"""How a long run over many cases tells how far it is."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING

import typer

from nxt_twin.cli.output import fail, progress

if TYPE_CHECKING:
    from nxt_twin.blind.spread import NameAndFailure


def _log(words: str, number: int, total: int) -> None:
    """Where no terminal shows a spinner, a long run tells each tenth of itself on standard error."""
    tenth = total // 10
    if tenth > 1 and number % tenth == 0 and not sys.stderr.isatty():
        print(words, file=sys.stderr, flush=True)


def follow_cases(title: str, outcomes: Iterable[NameAndFailure], total: int) -> None:
    """Show how far it is; leave with status 1 at the end if a case failed."""
    if followed(title, outcomes, total):
        raise typer.Exit(1)


def followed(title: str, outcomes: Iterable[NameAndFailure], total: int) -> bool:
    """Show how far it is; whether a case failed, each of which has a line on standard error."""
    failed = False
    with progress(title) as tell:
        for number, (name, why) in enumerate(outcomes, start=1):
            tell(f"{name}, {number} of {total}")
            _log(f"{title}: {number} of {total}", number, total)
            if why:
                fail(why)
                failed = True
    return failed
