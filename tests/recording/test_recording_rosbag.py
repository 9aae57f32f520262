"""Bags of arms: goals and readings in topics of their own, or in the state of a controller."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nxt_twin.recording.guess.guess import guess_mapping
from nxt_twin.recording.mapped import read_mapped
from nxt_twin.recording.mapping import mapping_of

_APART = "=" * 80
_HEADER = f"""{_APART}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
{_APART}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
_JOINTS = (
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"
    + _HEADER
)
_POINT = f"""{_APART}
MSG: trajectory_msgs/JointTrajectoryPoint
float64[] positions
float64[] velocities
float64[] accelerations
float64[] effort
builtin_interfaces/Duration time_from_start
{_APART}
MSG: builtin_interfaces/Duration
int32 sec
uint32 nanosec
"""
_STEP_S = 0.02
_GOALS = np.repeat([0.0, 0.5, -0.4, 0.3], 50)
_READINGS = np.convolve(_GOALS, np.full(10, 0.1))[: _GOALS.size]


def _controller(fields: tuple[str, ...]) -> str:
    points = "".join(f"trajectory_msgs/JointTrajectoryPoint {field}\n" for field in fields)
    return f"std_msgs/Header header\nstring[] joint_names\n{points}{_POINT}{_HEADER}"


def _stamp(row: int) -> dict[str, Any]:
    second, nanosecond = divmod(round(row * _STEP_S * 1e9), 10**9)
    return {"stamp": {"sec": 7 + second, "nanosec": nanosecond}, "frame_id": ""}


def _point(value: float) -> dict[str, Any]:
    clock = {"sec": 0, "nanosec": 0}
    return {
        "positions": [value],
        "velocities": [],
        "accelerations": [],
        "effort": [],
        "time_from_start": clock,
    }


def _bag(path: Path, kind: str, definition: str, messages: list[tuple[str, int, dict[str, Any]]]) -> Path:
    writer = pytest.importorskip("mcap_ros2.writer").Writer
    with path.open("wb") as file:
        bag = writer(file)
        schema = bag.register_msgdef(kind, definition)
        for topic, row, message in messages:
            at_ns = int((7 + row * _STEP_S) * 1e9)
            bag.write_message(topic, schema, {"header": _stamp(row), **message}, at_ns, at_ns)
        bag.finish()
    return path


def _state(value: float) -> dict[str, Any]:
    return {"name": ["elbow"], "position": [value], "velocity": [], "effort": []}


def _check(path: Path, command: str, reading: str) -> None:
    keys = guess_mapping(path).keys
    assert keys["input"] == {"column": command, "kind": "goal_position_rad"}
    assert keys["output"]["column"] == reading
    recording = read_mapped(path, mapping_of(keys, "guessed"))
    np.testing.assert_allclose(recording.columns["output"], _READINGS)
    np.testing.assert_allclose(recording.columns["input"], _GOALS)


def test_goals_in_a_topic_of_their_own_share_the_row_of_the_reading_with_their_stamp(tmp_path):
    pairs = [
        (topic, row, _state(value))
        for row, both in enumerate(zip(_GOALS, _READINGS, strict=True))
        for topic, value in zip(("/joint_commands", "/joint_states"), both, strict=True)
    ]
    path = _bag(tmp_path / "arm.mcap", "sensor_msgs/msg/JointState", _JOINTS, pairs)
    _check(path, "joint_commands.elbow.position", "joint_states.elbow.position")


@pytest.mark.parametrize("fields", [("reference", "feedback"), ("desired", "actual")])
def test_the_state_of_a_controller_holds_goal_and_reading(tmp_path, fields):
    states = [
        (
            "/arm/controller_state",
            row,
            {"joint_names": ["elbow"], **dict(zip(fields, map(_point, both), strict=True))},
        )
        for row, both in enumerate(zip(_GOALS, _READINGS, strict=True))
    ]
    kind = "control_msgs/msg/JointTrajectoryControllerState"
    path = _bag(tmp_path / "arm.mcap", kind, _controller(fields), states)
    command, reading = (f"arm.controller_state.{field}.elbow.position" for field in fields)
    _check(path, command, reading)


def test_a_position_that_is_commanded_is_a_goal(tmp_path):
    rows = [
        f"{row * _STEP_S:.2f},{a},{b:.5f}" for row, (a, b) in enumerate(zip(_GOALS, _READINGS, strict=True))
    ]
    path = tmp_path / "arm.csv"
    path.write_text("\n".join(["time_s,cmd_pos_rad,pos_rad", *rows]), encoding="utf-8")
    keys = guess_mapping(path).keys
    assert keys["input"] == {"column": "cmd_pos_rad", "kind": "goal_position_rad"}
    assert keys["output"]["column"] == "pos_rad"
