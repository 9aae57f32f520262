"""`nxt-twin map`: guess what the columns of a table are, and write the mapping."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from nxt_twin.recording.guess.guess import Guessed
    from nxt_twin.recording.recording import Recording


def map(  # noqa: A001  # the command's name
    table: Annotated[
        Path, typer.Argument(help="The table: any of CSV, JSON, Parquet, Feather, MAT, a ROS 2 bag.")
    ],
    out: Annotated[Path | None, typer.Option(help="Write the mapping here; else it is printed.")] = None,
    joint: Annotated[
        str | None, typer.Option(help="Name or index of the joint, where the table holds several.")
    ] = None,
) -> None:
    """Guess which columns of a table are time, command and angle, in which units, and say why.

    What is printed is the mapping, with the reasons as comments. Lines that say CHECK need your eye.
    """
    from nxt_twin.recording.guess.contract import is_recording
    from nxt_twin.recording.guess.guess import guess_mapping
    from nxt_twin.recording.guess.writing import mapping_text
    from nxt_twin.recording.mapped import read_all_mapped
    from nxt_twin.recording.mapping import mapping_of

    if joint is None and is_recording(table):
        print(
            f"# {table.name} has a recording's own columns: it needs no mapping; diagnose, fit and simulate read it"
        )
        return
    guessed = guess_mapping(table, joint)
    if guessed.lacking is not None:
        print(mapping_text(guessed, [f"what {table.name} seems to be, as far as it goes"]), end="")
        raise guessed.lacking
    recordings = read_all_mapped(table, mapping_of(guessed.keys, str(table)))
    text = mapping_text(guessed, _seen(guessed, recordings))
    if out is None:
        print(text, end="")
        return
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(text, encoding="utf-8")
    print(text, end="")
    print(f"# written to {out}; now: nxt-twin diagnose {table} --mapping {out}")


def _seen(guessed: Guessed, recordings: tuple[Recording, ...]) -> list[str]:
    """What the table holds once it is read so."""
    profile = guessed.profile
    rows = sum(recording.rows for recording in recordings)
    seconds = sum(recording.duration_s for recording in recordings)
    count = f"{len(recordings)} recordings" if len(recordings) > 1 else "one recording"
    rate = rows / seconds if seconds > 0.0 else 0.0
    unused = f"; no numbers in {', '.join(profile.others[:6])}" if profile.others else ""
    return [
        f"{profile.path.name}: {profile.kind}, {profile.rows} rows, {len(profile.columns)} columns of numbers{unused}",
        f"read so: {count}, {seconds:.4g} s, about {rate:.4g} rows a second",
    ]
