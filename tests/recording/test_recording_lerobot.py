"""LeRobot data sets as folders: one episode a file (version 2.1), or several (version 3)."""

import json

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest

from nxt_twin.errors import MappingError, RecordingError
from nxt_twin.recording.case import read_as_case
from nxt_twin.recording.column_words import mapping_of_words
from nxt_twin.recording.mapped import read_all_mapped

JOINTS = ("shoulder_pan", "shoulder_lift", "elbow_flex")
ROWS = 120
T = np.arange(ROWS) / 30


def episode(number, moving):
    state = np.zeros((ROWS, 3))
    for joint in moving:
        state[:, joint] = np.round(40 * np.sin((3 + joint + 0.1 * number) * T) / 0.088) * 0.088

    def vectors(values):
        return pa.FixedSizeListArray.from_arrays(pa.array(values.astype("f4").ravel()), 3)

    return pa.table(
        {
            "action": vectors(np.roll(state, -2, axis=0)),
            "observation.state": vectors(state),
            "timestamp": pa.array(T.astype("f4")),
            "frame_index": np.arange(ROWS),
            "episode_index": np.full(ROWS, number),
            "index": number * ROWS + np.arange(ROWS),
            "task_index": np.zeros(ROWS, dtype=int),
        }
    )


@pytest.fixture
def data_set(tmp_path):
    """Writes a data set of a version, with files of some episodes each."""

    def write(version, files, *, moving=(2,), robot="so101_follower"):
        root = tmp_path / "arm"
        names = [f"{joint}.pos" for joint in JOINTS] if version == "v3.0" else {"motors": list(JOINTS)}
        name = "file-{:03d}" if version == "v3.0" else "episode_{:06d}"
        for number, episodes in enumerate(files):
            path = root / "data" / "chunk-000" / f"{name.format(number)}.parquet"
            path.parent.mkdir(parents=True, exist_ok=True)
            tables = [episode(each, moving) for each in episodes]
            pyarrow.parquet.write_table(pa.concat_tables(tables), path)
        features = {
            key: {"dtype": "float32", "shape": [3], "names": names} for key in ("action", "observation.state")
        }
        info = {"codebase_version": version, "robot_type": robot, "fps": 30, "features": features}
        (root / "meta").mkdir(parents=True)
        (root / "meta" / "info.json").write_text(json.dumps(info))
        return root

    return write


@pytest.mark.parametrize(("version", "files"), [("v2.1", [[0], [1], [2]]), ("v3.0", [[0, 1], [2]])])
def test_a_folder_is_a_case_of_all_its_episodes(data_set, version, files):
    case = read_as_case(data_set(version, files))
    assert [each.name for each in case.recordings] == ["arm#0", "arm#1", "arm#2"]
    assert case.plant == "servo_sts3215"
    for number, recording in enumerate(case.recordings):
        state = np.array(episode(number, (2,))["observation.state"].to_pylist())[:, 2]
        np.testing.assert_allclose(np.degrees(recording.columns["output"]), state, atol=1e-5)
        assert recording.kinds.input == "goal_position_rad"
        assert np.degrees(recording.output_quantum) == pytest.approx(0.088, rel=1e-3)


def test_an_episode_and_a_joint_are_named_behind_the_folder(data_set, refusal):
    root = data_set("v3.0", [[0, 1]])
    (second,) = read_as_case(root.with_name("arm#elbow_flex#1")).recordings
    assert second.rows == ROWS
    assert "shoulder_pan, shoulder_lift, elbow_flex" in refusal(
        MappingError, read_as_case, root.with_name("arm#knee")
    )
    stated = "time=timestamp,goal=action[elbow_flex],angle=observation.state[elbow_flex],split=episode_index"
    found = read_all_mapped(root, mapping_of_words(stated))
    np.testing.assert_array_equal(found[1].columns["output"], second.columns["output"])


def test_joints_that_move_at_once_are_refused_by_name(data_set, refusal):
    root = data_set("v2.1", [[0]], moving=(0, 1, 2))
    line = refusal(RecordingError, read_as_case, root.with_name("arm#elbow_flex"))
    assert "shoulder_pan (by 80 deg), shoulder_lift (by 80 deg)" in line


def test_a_folder_without_episodes_is_refused(data_set, refusal):
    assert "holds no episode" in refusal(RecordingError, read_as_case, data_set("v2.1", []))
