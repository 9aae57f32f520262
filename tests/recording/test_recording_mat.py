"""MAT tables."""

import numpy as np
import pytest
from scipy.io import savemat

from nxt_twin.errors import MappingError, RecordingError
from nxt_twin.recording.mapped import read_mapped
from nxt_twin.recording.mapping import Mapping

MAPPING = Mapping.model_validate(
    {
        "table": {"format": "mat"},
        "time": {"column": "t"},
        "input": {"column": "vir", "kind": "force_n", "gain": 35.0},
        "output": {"column": "qm", "kind": "position_m"},
    }
)
GOOD = {
    "t": np.array([[0.0], [0.001], [0.002]]),
    "vir": np.array([1, 2, 3], dtype=np.uint8),
    "qm": np.array([0.0, np.nan, 1e-5]),
    "note": "anything",
}


def test_reads_vectors_of_any_number_type_and_orientation(tmp_path):
    savemat(tmp_path / "run.mat", GOOD)
    recording = read_mapped(tmp_path / "run.mat", MAPPING)
    np.testing.assert_array_equal(recording.time_s, [0.0, 0.001, 0.002])
    np.testing.assert_array_equal(recording.columns["input"], [35.0, 70.0, 105.0])
    np.testing.assert_array_equal(recording.columns["output"], [0.0, np.nan, 1e-5])


@pytest.mark.parametrize(
    ("changes", "error", "part"),
    [
        ({"qm": np.zeros(2)}, RecordingError, "differ in length: t 3, vir 3, qm 2"),
        ({"qm": np.zeros((3, 2))}, RecordingError, "column qm: is float64 of shape (3, 2)"),
        ({"qm": np.zeros(3) * 1j}, RecordingError, "column qm: is complex128"),
        ({"qm": {"a": 1.0}}, RecordingError, "column qm"),
        ({"qm": "text"}, RecordingError, "column qm"),
        ({"vir": np.array([0.0, np.inf, 0.0])}, RecordingError, "row 2, column vir: is not finite"),
        ({"t": np.array([0.0, 2.0, 1.0])}, RecordingError, "row 3, column t: time runs backwards"),
        ({"t": np.array([0.0, np.nan, 1.0])}, RecordingError, "row 2, column t: has no time stamp"),
    ],
)
def test_refuses_variables_that_are_no_recording(tmp_path, refusal, changes, error, part):
    savemat(tmp_path / "run.mat", GOOD | changes)
    assert part in refusal(error, read_mapped, tmp_path / "run.mat", MAPPING)


def test_refuses_a_missing_variable_naming_the_nearest(tmp_path, refusal):
    savemat(tmp_path / "run.mat", {"t": GOOD["t"], "vir": GOOD["vir"], "qg": GOOD["qm"]})
    line = refusal(MappingError, read_mapped, tmp_path / "run.mat", MAPPING)
    assert "no column 'qm'" in line
    assert "nearest known: qg" in line


@pytest.mark.parametrize("offset", [0, 512])
def test_refuses_version_7_3_clearly(put, refusal, offset):
    path = put("run.mat", b"M" * offset + b"\x89HDF\r\n\x1a\n" + b"\0" * 100)
    line = refusal(RecordingError, read_mapped, path, MAPPING)
    assert "7.3" in line
    assert "-v7" in line


@pytest.mark.parametrize(
    "content", [b"not a mat file at all", b"\0" * 200, b"MATLAB 5.0 MAT-file" + b"\1" * 300]
)
def test_refuses_a_damaged_file(put, refusal, content):
    assert "no readable MAT file" in refusal(RecordingError, read_mapped, put("run.mat", content), MAPPING)


def test_refuses_a_file_cut_short(tmp_path, refusal):
    path = tmp_path / "run.mat"
    savemat(path, GOOD | {"qm": np.arange(2000.0)}, do_compression=True)
    path.write_bytes(path.read_bytes()[:-500])
    refusal(RecordingError, read_mapped, path, MAPPING)
