"""Bags of ROS 2 in MCAP or SQLite: joint states, states of controllers and plain numbers, one row a stamp."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from nxt_twin.errors import RecordingError
from nxt_twin.recording.source import read_table_head
from nxt_twin.recording.tables.loose import loose_table
from nxt_twin.recording.tables.rosbag_sqlite import Message, sqlite_messages
from nxt_twin.recording.tables.table import Choose, Table, check_unfolded

STAMP = "stamp_s"
LOGGED = "logged_s"
_JOINT_STATE = "sensor_msgs/msg/JointState"
_JOINT_PARTS = ("position", "velocity", "effort")
_NUMBERS = frozenset(
    f"std_msgs/msg/{kind}"
    for kind in (*(f"{sort}{bits}" for sort in ("Float", "Int", "UInt") for bits in (32, 64)), "Bool")
)
_LISTS = frozenset({"std_msgs/msg/Float64MultiArray", "std_msgs/msg/Float32MultiArray"})
_BY_NAME = frozenset({_JOINT_STATE, *_NUMBERS, *_LISTS})
_CONTROLLER = "control_msgs/msg/JointTrajectoryControllerState"
_CONTROLLER_POINTS = ("reference", "feedback", "output", "desired", "actual")
_POINT_PARTS = {"positions": "position", "velocities": "velocity", "effort": "effort"}
_READ = _BY_NAME | {_CONTROLLER}
_SQLITE = b"SQLite format 3\0"
_RECOVER = {
    False: "mcap recover mends one that was not",
    True: "ros2 bag reindex or sqlite3 .recover mends one",
}
_NANOSECOND_S = 1e-9


def read_rosbag(path: Path, choose: Choose) -> Table:
    """Read the chosen columns of a bag.

    Columns are `stamp_s` (of the message's header, or the time of logging) and `logged_s`. Joint states give
    `TOPIC.JOINT.position`, `….velocity` and `….effort`. The state of a controller of trajectories gives
    `TOPIC.reference.JOINT.position`, `TOPIC.feedback.JOINT.position` and so on, from MCAP. Numbers give `TOPIC.data`,
    and lists `TOPIC.data[0]`. Rows are in the order of `stamp_s`, and topics of one stamp share a row; a cell is
    empty in the rows of other topics.

    Raises:
        RecordingError: the extra `rosbag` is not installed, or the file is no bag of ROS 2. Or the bag holds
            no joint states and no numbers. `choose` may raise its own.
    """
    sqlite = read_table_head(path, RecordingError).startswith(_SQLITE)
    rows = _united(sorted(_rows(path, sqlite=sqlite), key=lambda row: float(row[STAMP])))
    names = list(dict.fromkeys(name for row in rows for name in row))
    if not rows:
        mend = f"record a topic of {_JOINT_STATE}"
        raise RecordingError("holds no joint states and no numbers", where=str(path), mend=mend)
    check_unfolded(len(rows) * len(names), path)
    return loose_table({name: [row.get(name) for row in rows] for name in names}, path, choose)


def _united(rows: Sequence[dict[str, float]]) -> list[dict[str, float]]:
    """The rows, with those of one stamp in one, unless they hold one column twice."""
    united: list[dict[str, float]] = []
    for row in rows:
        last = united[-1] if united else {}
        if last.get(STAMP) == row[STAMP] and last.keys() & row.keys() == {STAMP, LOGGED}:
            united[-1] = last | row
        else:
            united.append(row)
    return united


def _rows(path: Path, *, sqlite: bool) -> Iterator[dict[str, float]]:
    try:
        for kind, topic, logged_ns, decoded in (_sqlite if sqlite else _mcap)(path):
            logged_s = logged_ns * _NANOSECOND_S
            cells = _cells(kind, topic.strip("/").replace("/", "."), decoded)
            yield {STAMP: _stamp_s(decoded) or logged_s, LOGGED: logged_s, **cells}
    except ImportError:
        mend = "pip install 'nxt-twin[rosbag]'"
        raise RecordingError(
            "is a bag, for which the extra rosbag is needed", where=str(path), mend=mend
        ) from None
    except RecordingError:
        raise
    except Exception as failure:  # a damaged bag makes the decoder fail in any way it can
        mend = f"check that the bag was closed; {_RECOVER[sqlite]}"
        raise RecordingError(f"is no readable bag: {failure}", where=str(path), mend=mend) from None


def _mcap(path: Path) -> Iterator[Message]:
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        topics = _topics(reader)
        for schema, channel, message, decoded in reader.iter_decoded_messages(topics=topics):
            yield Message(schema.name if schema else "", channel.topic, message.log_time, decoded)


def _sqlite(path: Path) -> Iterator[Message]:
    return sqlite_messages(path, _BY_NAME)


def _topics(reader: Any) -> list[str]:  # noqa: ANN401  # mcap's reader comes without types
    """The topics whose messages are read."""
    summary = reader.get_summary()
    if summary is None:
        return []
    return [each.topic for each in summary.channels.values() if summary.schemas[each.schema_id].name in _READ]


def _stamp_s(decoded: Any) -> float:  # noqa: ANN401  # a message of any type
    header = getattr(decoded, "header", None)
    return header.stamp.sec + header.stamp.nanosec * _NANOSECOND_S if header else 0.0


def _cells(schema: str, topic: str, decoded: Any) -> dict[str, float]:  # noqa: ANN401  # a message of any type
    if schema in _NUMBERS:
        return {f"{topic}.data": float(decoded.data)}
    if schema in _LISTS:
        return {f"{topic}.data[{index}]": float(value) for index, value in enumerate(decoded.data)}
    if schema == _CONTROLLER:
        return _controller_cells(topic, decoded)
    return {
        f"{topic}.{joint}.{part}": float(value)
        for part in _JOINT_PARTS
        for joint, value in zip(decoded.name, getattr(decoded, part), strict=False)
    }


def _controller_cells(topic: str, decoded: Any) -> dict[str, float]:  # noqa: ANN401  # a message of any type
    """What a controller was to reach, what it read and what it gave; releases of ROS name these differently."""
    points = {name: getattr(decoded, name) for name in _CONTROLLER_POINTS if hasattr(decoded, name)}
    return {
        f"{topic}.{name}.{joint}.{part}": float(value)
        for name, point in points.items()
        for field, part in _POINT_PARTS.items()
        for joint, value in zip(decoded.joint_names, getattr(point, field), strict=False)
    }
