"""One joint of an arm whose other joints rest, or do not."""

import numpy as np
import pytest

from nxt_twin.errors import MappingError, RecordingError
from nxt_twin.recording.mapped import read_all_mapped
from nxt_twin.recording.mapping import mapping_of

ROWS = 900
T = 0.01 * np.arange(ROWS)
ELBOW = np.round(50.0 * np.sin(3.0 * T), 2)
SHOULDER = np.interp(T, [0.0, 4.0, 4.5, 9.0], [0.0, 0.0, 30.0, 30.0])
WRIST = np.where(T < 6.5, 0.0, 20.0)


@pytest.fixture
def arm(put):
    """Reads the elbow of an arm beside joints, given by name as angles in degrees with their signs."""

    def read(joints, **changes):
        columns = [T, ELBOW, ELBOW, *(angle for angle, _ in joints.values())]
        rows = "\n".join(",".join(f"{cell:g}" for cell in row) for row in zip(*columns, strict=True))
        table = put("arm.csv", ",".join(["t", "goal", "elbow", *joints]) + "\n" + rows)
        keys = {
            "time": {"column": "t"},
            "input": {"column": "goal", "kind": "goal_position_deg"},
            "output": {"column": "elbow", "kind": "position_deg"},
            "gravity_of": {
                name: {"column": name, "kind": "position_deg", "sign": sign}
                for name, (_, sign) in joints.items()
            },
        }
        return read_all_mapped(table, mapping_of({**keys, **changes}, "test"))

    return read


def test_stretches_in_which_the_carrying_joint_rests_have_angles_from_the_foot(arm):
    first, second = arm({"shoulder": (SHOULDER, -1.0)})
    assert (first.name, second.name) == ("arm.csv~1", "arm.csv~2")
    assert first.time_s[-1] == pytest.approx(4.0, abs=0.02)
    late = second.time_s[0] - 1e-9 <= T
    for column in ("input", "output"):
        np.testing.assert_allclose(np.degrees(second.columns[column]), ELBOW[late] - 30.0, atol=0.6)


def test_a_joint_further_out_has_to_rest_and_adds_no_angle(arm):
    found = arm({"shoulder": (0.0 * T, 1.0), "wrist": (WRIST, 0.0)})
    assert [round(each.time_s[0], 2) for each in found] == [0.0, 6.5]
    np.testing.assert_allclose(np.degrees(found[1].columns["output"]), ELBOW[T >= 6.495], atol=1e-9)


def test_joints_that_move_at_once_are_named(arm, refusal):
    moving = {"shoulder": (20.0 * np.sin(T), 1.0), "wrist": (0.0 * T, 0.0)}
    line = refusal(RecordingError, arm, moving)
    assert "mapping key gravity_of" in line
    assert "shoulder (by 40 deg)" in line
    assert "wrist" not in line


def test_a_speed_has_no_gravity_of_other_joints(arm):
    speed = {"column": "elbow", "kind": "speed_deg_per_s"}
    with pytest.raises(MappingError, match="gravity_of needs an output of kind position_deg"):
        arm({"shoulder": (SHOULDER, 1.0)}, output=speed)
