"""`nxt-twin map`: guess what the columns of a table are, and write the mapping."""

from __future__ import annotations

import json as json_format
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Annotated

import typer

from nxt_twin.cli.output import JsonOption, emit_json

if TYPE_CHECKING:
    from nxt_twin.recording.guess.guess import Guessed
    from nxt_twin.recording.recording import Recording

_PLANT = (
    "a robot on two wheels: its plant is not in the table. Write it into NAME.yaml beside: "
    "plant: {kind: differential_drive, left: b, right: c, left_wheel_radius_m: 0.028, right_wheel_radius_m: 0.028, "
    "track_m: 0.103}"
)


def map(  # noqa: A001  # the command's name
    table: Annotated[
        Path,
        typer.Argument(
            help="The table: text, JSON, Parquet, Feather, MAT, a ROS 2 bag or a LeRobot data set."
        ),
    ],
    out: Annotated[Path | None, typer.Option(help="Write the mapping here; without: print it.")] = None,
    joint: Annotated[
        str | None, typer.Option(help="Name or index of the joint, where the table holds several.")
    ] = None,
    json: JsonOption = None,
) -> None:
    """Guess which columns of a table are time, command and angle, in which units, and say why.

    The output is the mapping, with the reasons as comments. Check each line that says CHECK.
    """
    from nxt_twin.errors import RecordingError
    from nxt_twin.recording.any_mapping import any_mapping_of
    from nxt_twin.recording.guess.contract import is_recording
    from nxt_twin.recording.guess.guess import guess_mapping
    from nxt_twin.recording.guess.writing import mapping_text
    from nxt_twin.recording.mapped import read_all_mapped

    if joint is None and is_recording(table):
        _tell(_unneeded(table, out), json, None)
        return
    guessed = guess_mapping(table, joint)
    if guessed.lacking is not None:
        if json != "-":
            print(mapping_text(guessed, [f"a first guess for {table.name}, which is incomplete"]), end="")
        raise guessed.lacking
    try:
        seen = _seen(guessed, read_all_mapped(table, any_mapping_of(guessed.keys, str(table))))
    except RecordingError as error:
        if "gravity_of" not in guessed.keys:
            raise
        seen = [f"CHECK {error}"]
    text = mapping_text(guessed, seen)
    if out:
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(text, encoding="utf-8")
    written = f"# written to {out}; now: {_next(table, out)}\n" if out else ""
    _tell(text + written, json, guessed)


def _unneeded(table: Path, out: Path | None) -> str:
    """What is said of a recording, for which no mapping is written."""
    unwritten = f"; {out} is not written" if out else ""
    return (
        f"# {table.name} has a recording's own columns and needs no mapping{unwritten}\n"
        f"# now: nxt-twin diagnose {quote(str(table))}\n"
    )


def _next(table: Path, out: Path) -> str:
    """The command that reads the table; a mapping of the table's own name beside it needs no option."""
    option = "" if out.resolve() == table.resolve().with_suffix(".yaml") else f" --mapping {quote(str(out))}"
    return f"nxt-twin diagnose {quote(str(table))}{option}"


def _tell(text: str, json: str | None, guessed: Guessed | None) -> None:
    """Print the text, and write the mapping with its reasons as JSON."""
    if json:
        why = {guess.key: guess.why for guess in guessed.guesses} if guessed else {}
        keys = guessed.keys if guessed else None
        emit_json(json, json_format.dumps({"schema": "nxt-twin/map/1", "mapping": keys, "why": why}))
    if json != "-":
        print(text, end="")


def _seen(guessed: Guessed, recordings: tuple[Recording, ...]) -> list[str]:
    """What the table holds once it is read so."""
    from nxt_twin.recording.robot_keys import is_robots

    profile = guessed.profile
    rows = sum(recording.rows for recording in recordings)
    seconds = sum(recording.duration_s for recording in recordings)
    count = f"{len(recordings)} recordings" if len(recordings) > 1 else "one recording"
    rate = rows / seconds if seconds > 0.0 else 0.0
    idle = [name for name in profile.others if name not in _columns_in(guessed.keys)]
    unused = f"; no numbers in {', '.join(idle[:6])}" if idle else ""
    robot = [_PLANT] if is_robots(guessed.keys) else []
    return [
        f"{profile.path.name}: {profile.kind}, {profile.rows} rows, {len(profile.columns)} columns of numbers{unused}",
        f"read so: {count}, {seconds:.4g} s, about {rate:.4g} rows a second",
        *robot,
    ]


def _columns_in(keys: object) -> set[str]:
    """The columns that a mapping names, at any depth."""
    within = keys.values() if isinstance(keys, dict) else keys if isinstance(keys, list) else ()
    own = {keys["column"]} if isinstance(keys, dict) and isinstance(keys.get("column"), str) else set()
    return own.union(*(_columns_in(each) for each in within))
