"""A run as MCAP with messages of ROS 2: Foxglove, PlotJuggler, rerun and ROS itself read it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np

from nxt_twin.errors import NxtTwinError
from nxt_twin.export.run import MEASURED, Curve, DrawnRun, Remark
from nxt_twin.recording.columns import PORTS, tacho_column

_SECOND_NS: Final = 1_000_000_000
_JOINTS: Final = "/joint_states"
_REMARKS: Final = "/remarks"
_TYPES: Final = {
    "std_msgs/msg/Float64": "float64 data",
    "std_msgs/msg/String": "string data",
    "sensor_msgs/msg/JointState": """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec""",
}

_Message = tuple[int, str, str, dict[str, Any]]
"""Time in ns, topic, type and content."""


def write_mcap(run: DrawnRun, path: Path) -> None:
    """Write a run; its times are those of the recording's own clock.

    A topic `/measured/COLUMN` or `/predicted/COLUMN` holds each curve as numbers, `/joint_states` the motors' angles in
    rad, and `/remarks` what a diagnosis says.

    Raises:
        NxtTwinError: the extra `rosbag` is not installed.
        OSError: the file cannot be written.
    """
    try:
        from mcap_ros2.writer import Writer
    except ImportError:
        mend = "pip install 'nxt-twin[rosbag]'"
        raise NxtTwinError("MCAP needs mcap, which is not installed", mend=mend) from None
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("wb") as file:
        writer = Writer(file)
        schemas = {name: writer.register_msgdef(name, text) for name, text in _TYPES.items()}
        for number, (at_ns, topic, kind, content) in enumerate(
            sorted(_messages(run), key=lambda one: one[0])
        ):
            writer.write_message(topic, schemas[kind], content, at_ns, at_ns, number)
        writer.finish()  # type: ignore[no-untyped-call]


def _messages(run: DrawnRun) -> Iterator[_Message]:
    for curve in run.curves:
        topic = f"/{curve.side}/{curve.column}"
        for time_s, value in zip(curve.time_s.tolist(), curve.values.tolist(), strict=True):
            yield _ns(time_s), topic, "std_msgs/msg/Float64", {"data": value}
    motors = {tacho_column(port): port for port in PORTS}
    for curve in run.curves:
        if curve.side == MEASURED and curve.column in motors:
            yield from _joints(curve, motors[curve.column])
    for remark in run.remarks:
        yield _remark(remark)


def _joints(curve: Curve, name: str) -> Iterator[_Message]:
    for time_s, angle_rad in zip(curve.time_s.tolist(), np.radians(curve.values).tolist(), strict=True):
        sec, nanosec = divmod(_ns(time_s), _SECOND_NS)
        content = {
            "header": {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": ""},
            "name": [name],
            "position": [angle_rad],
            "velocity": [],
            "effort": [],
        }
        yield _ns(time_s), _JOINTS, "sensor_msgs/msg/JointState", content


def _remark(remark: Remark) -> _Message:
    return _ns(remark.time_s), _REMARKS, "std_msgs/msg/String", {"data": remark.text}


def _ns(time_s: float) -> int:
    """Nanoseconds; MCAP knows no time before its zero."""
    return max(0, round(time_s * _SECOND_NS))
