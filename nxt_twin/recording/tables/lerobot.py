"""LeRobot data sets: a folder of Parquet files, one an episode (version 2) or several episodes in each (version 3)."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from nxt_twin.errors import RecordingError
from nxt_twin.recording.source import read_head
from nxt_twin.recording.tables.nested import split_name
from nxt_twin.recording.tables.parquet import read_parquet
from nxt_twin.recording.tables.table import LARGEST_CELLS, CellKind, Choose, Table

INFO = "meta/info.json"
STATE, ACTION = "observation.state", "action"

_FILES = "data/**/*.parquet"
_LARGEST_INFO_BYTES = 2**20
_SUFFIX = ".pos"
"""Behind a joint's name where version 3 says what of the joint a number is."""


def is_data_set(folder: Path) -> bool:
    """Whether a folder is a LeRobot data set."""
    return (folder / INFO).is_file()


def read_lerobot(folder: Path, choose: Choose) -> Table:
    """Read the chosen columns of all episodes, one file after the other.

    An element of a list may be named by its joint: `observation.state[elbow_flex]`.

    Raises:
        RecordingError: the folder holds no episode, the files differ, or one of them is no Parquet file.
            `choose` may raise its own.
    """
    files = sorted(folder.glob(_FILES))
    if not files:
        mend = "name the folder that holds `meta` and `data`"
        raise RecordingError("holds no episode", where=f"{folder}, data", mend=mend)
    stored_as = {f"{split_name(name)[0]}[{joint}]": name for name, joint in joints_of(folder).items()}
    wanted: dict[str, CellKind] = {}

    def chosen(found: Sequence[str]) -> Mapping[str, CellKind]:
        wanted.update(choose([*found, *(name for name, stored in stored_as.items() if stored in found)]))
        return {stored_as.get(name, name): kind for name, kind in wanted.items()}

    tables: list[Table] = []
    for file in files:
        tables.append(read_parquet(file, chosen))
        if sum(_cells(table) for table in tables) > LARGEST_CELLS:
            raise RecordingError("holds too many cells", where=str(folder), mend="name one of its files")
    return _joined(tables, {name: stored_as.get(name, name) for name in wanted}, folder)


def _cells(table: Table) -> int:
    return sum(values.size for values in table.numbers.values()) + sum(map(len, table.words.values()))


def _joined(tables: Sequence[Table], stored_as: Mapping[str, str], folder: Path) -> Table:
    """The tables one after the other, with the columns under the names by which they were chosen."""
    first = tables[0]
    numbers = {
        n: np.concatenate([t.numbers[s] for t in tables]) for n, s in stored_as.items() if s in first.numbers
    }
    words = {
        n: tuple(chain.from_iterable(t.words[s] for t in tables))
        for n, s in stored_as.items()
        if s in first.words
    }
    return Table(numbers, words, lambda index, name: f"{folder}, row {index + 1}, column {name}")


def joints_of(folder: Path) -> dict[str, str]:
    """The joints' names by column, as `meta/info.json` gives them; none where it gives none."""
    features = info_of(folder).get("features")
    if not isinstance(features, dict):
        return {}
    return {
        f"{column}[{index}]": str(joint).removesuffix(_SUFFIX)
        for column in (STATE, ACTION)
        for index, joint in enumerate(_listed(features.get(column)))
    }


def info_of(folder: Path) -> dict[str, Any]:
    """What `meta/info.json` says; nothing where it is no JSON."""
    path = folder / INFO
    advice = "check that it is a description"
    read_head(path, RecordingError, largest_bytes=_LARGEST_INFO_BYTES, advice=advice)
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}


def _listed(feature: object) -> Sequence[object]:
    """The names of a feature's elements: a list, also where it stands under a key such as `motors`."""
    names = feature.get("names") if isinstance(feature, dict) else None
    if isinstance(names, dict):
        names = next(iter(names.values()), None)
    return names if isinstance(names, list) else []
