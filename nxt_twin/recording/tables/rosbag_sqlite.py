"""The messages of a ROS 2 bag in SQLite (`.db3`), which many such bags hold without their definitions."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any, Final, NamedTuple

from nxt_twin.errors import RecordingError

_APART = "=" * 80
_JOINT_STATE = f"""std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
{_APART}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
{_APART}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
_MULTI_ARRAY = f"""std_msgs/MultiArrayLayout layout
{{element}}[] data
{_APART}
MSG: std_msgs/MultiArrayLayout
std_msgs/MultiArrayDimension[] dim
uint32 data_offset
{_APART}
MSG: std_msgs/MultiArrayDimension
string label
uint32 size
uint32 stride
"""
_ROWS = (
    "SELECT topics.name, topics.type, messages.timestamp, messages.data "
    "FROM messages JOIN topics ON messages.topic_id = topics.id ORDER BY messages.timestamp"
)


class Message(NamedTuple):
    """One decoded message of a bag."""

    kind: str
    topic: str
    logged_ns: int
    decoded: Any


def definition(kind: str) -> str:
    """The text that defines a joint state, a number or a list of numbers."""
    if kind == "sensor_msgs/msg/JointState":
        return _JOINT_STATE
    name = kind.rpartition("/")[2]
    if name.endswith("MultiArray"):
        return _MULTI_ARRAY.format(element=name.removesuffix("MultiArray").lower())
    return f"{name.lower()} data\n"


def sqlite_messages(path: Path, kinds: frozenset[str]) -> Iterator[Message]:
    """Decode all messages of these kinds.

    Raises:
        RecordingError: the file is a database, but no bag.
        ImportError: the extra `rosbag` is not installed.
    """
    from mcap.records import Schema
    from mcap_ros2.decoder import DecoderFactory

    factory = DecoderFactory()
    decoders = {
        kind: factory.decoder_for(
            "cdr", Schema(id=index, name=kind, encoding="ros2msg", data=definition(kind).encode())
        )
        for index, kind in enumerate(sorted(kinds), start=1)
    }
    with closing(_opened(path)) as bag:
        _check_bag(bag, path)
        for topic, kind, logged_ns, data in bag.execute(_ROWS):
            decode = decoders.get(kind)
            if decode is not None:
                yield Message(kind, topic, logged_ns, decode(data))


_UNFINISHED: Final = "-wal"
"""SQLite's file beside a bag that was not closed; a closed one is read without a lock, in a read-only folder too."""


def _opened(path: Path) -> sqlite3.Connection:
    unfinished = path.with_name(path.name + _UNFINISHED).exists()
    return sqlite3.connect(
        f"{path.resolve().as_uri()}?{'mode=ro' if unfinished else 'immutable=1'}", uri=True
    )


def _check_bag(bag: sqlite3.Connection, path: Path) -> None:
    tables = {name for (name,) in bag.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
    if not {"topics", "messages"} <= tables:
        mend = "export one of its tables as CSV"
        raise RecordingError("is a SQLite database, but no bag of ROS 2", where=str(path), mend=mend)
