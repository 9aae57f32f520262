"""`nxt-twin prepare`: make a case of a real data set that is on this machine."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from nxt_twin.recording.realdata import DATA_SETS, data_root, prepare_case


def prepare(
    name: Annotated[str, typer.Argument(help=f"One of {', '.join(DATA_SETS)}.")],
    out: Annotated[Path, typer.Option(help="Folder in which to make the case.")],
    data: Annotated[Path | None, typer.Option(help="Where the data sets are; else $NXT_TWIN_DATA.")] = None,
) -> None:
    """Make a case of a real data set: the baseline, and recordings split into fitted and held-out ones."""
    if name not in DATA_SETS:
        raise typer.BadParameter(f"'{name}' is none of {', '.join(DATA_SETS)}", param_hint="NAME")
    print(prepare_case(name, data or data_root(), out))
