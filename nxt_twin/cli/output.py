"""What commands share: where JSON goes, progress, and how failures end."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from nxt_twin.recording.case import Case

JsonOption = Annotated[
    str | None,
    typer.Option(
        "--json", metavar="FILE|-", help="Write the answer as JSON; - is standard output, and nothing else."
    ),
]


def emit_json(target: str, text: str) -> None:
    """Write `text` to the file `target`, or to standard output if it is `-`."""
    if target == "-":
        print(text, flush=True)
    else:
        path = Path(target)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text + "\n", encoding="utf-8")


@contextmanager
def progress(title: str) -> Iterator[Callable[[str], None]]:
    """Show on standard error what is being done: a spinner on a terminal, nothing elsewhere."""
    from rich.console import Console

    console = Console(stderr=True)
    with console.status(f"{title} …") as status:
        yield lambda doing: status.update(f"{title}: {doing} …")


def remark(case: Case) -> None:
    """Say on standard error what had to be found of a case's recordings."""
    for line in case.remarks():
        fail(line)


def fail(message: str) -> None:
    """One line on standard error."""
    print(f"nxt-twin: {message}", file=sys.stderr)
