"""The options of commands that read tables from elsewhere: `--mapping` and `--columns`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from nxt_twin.recording.mappings import MappingOf

MappingOption = Annotated[
    Path | None,
    typer.Option("--mapping", help="Mapping file for tables from elsewhere; nxt-twin map writes one."),
]
ColumnsOption = Annotated[
    str | None,
    typer.Option(
        "--columns",
        metavar="ROLE=COLUMN:UNIT,…",
        help="The table's columns, such as time=ms:ms,power=pwm,angle=ticks:0.088deg.",
    ),
]


def stated_mapping(mapping: Path | None, columns: str | None) -> MappingOf | None:
    """The mapping that the command line states for all its tables; None leaves it to cases and sidecars.

    Raises:
        MappingError: it is none.
    """
    if mapping and columns:
        raise typer.BadParameter("give --mapping or --columns, not both")
    if not mapping and not columns:
        return None
    from nxt_twin.recording.mappings import one_mapping, read_mappings

    if columns:
        from nxt_twin.recording.column_words import mapping_of_words

        return one_mapping(mapping_of_words(columns))
    return read_mappings(mapping) if mapping else None
