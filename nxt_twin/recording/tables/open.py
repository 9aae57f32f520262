"""Open any table: its format is found by content where nobody states it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

from nxt_twin.errors import RecordingError
from nxt_twin.recording.tables.content import TableKind, check_stated_kind, kind_of, text_layout
from nxt_twin.recording.tables.json_text import read_json
from nxt_twin.recording.tables.labels import read_labels
from nxt_twin.recording.tables.lerobot import is_data_set, read_lerobot
from nxt_twin.recording.tables.mat import read_mat
from nxt_twin.recording.tables.parquet import read_feather, read_parquet
from nxt_twin.recording.tables.rosbag import read_rosbag
from nxt_twin.recording.tables.table import Choose, Table
from nxt_twin.recording.tables.text import read_text

_READERS: Mapping[TableKind, Callable[[Path, Choose], Table]] = MappingProxyType(
    {
        "json": read_json,
        "labels": read_labels,
        "lerobot": read_lerobot,
        "parquet": read_parquet,
        "feather": read_feather,
        "mat": read_mat,
        "mcap": read_rosbag,
        "db3": read_rosbag,
    }
)
_BAGS = ("*.mcap", "*.db3", "*.db3.zstd")  # the third is refused by its content, with the way to unpack it


def read_table(path: Path, choose: Choose, kind: TableKind | None, given: Mapping[str, object]) -> Table:
    """Read the chosen columns of any table.

    Args:
        path: the file.
        choose: says which columns.
        kind: the format; None where the content has to tell.
        given: what is known of a text table, by the names of `TextLayout`; the rest is found.

    Raises:
        RecordingError: the file cannot be read as a table. `choose` may raise its own.
    """
    if kind is not None:
        check_stated_kind(path, kind)
    found = kind or kind_of(path)
    if found != "csv":
        return _READERS[found](path, choose)
    return read_text(path, text_layout(path, given), choose)


def table_file(path: Path) -> Path:
    """The file itself; of a bag, the one in its folder; of a LeRobot data set, the folder.

    Raises:
        RecordingError: the folder holds none, or a bag in several parts.
    """
    if not path.is_dir() or is_data_set(path):
        return path
    parts = next(filter(None, (sorted(path.glob(bag)) for bag in _BAGS)), [])
    if len(parts) > 1:
        mend = f"name one, such as {parts[0].name}; ros2 bag convert joins them"
        raise RecordingError(f"is a bag in {len(parts)} parts", where=str(path), mend=mend)
    if parts:
        return parts[0]
    mend = "name a file in it"
    raise RecordingError("is a folder with neither a bag nor a data set", where=str(path), mend=mend)
