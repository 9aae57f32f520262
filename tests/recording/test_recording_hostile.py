"""Whatever a file holds, it is read or refused in one line."""

import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from nxt_twin.errors import NxtTwinError, RecordingError
from nxt_twin.recording.files import read_recording
from nxt_twin.recording.mapping import Mapping, read_mapped, read_mapping

HEADER = b"time_s,a_power_pct,a_mode,a_tacho_deg\n"
SCRAPS = [
    b",",
    b"\n",
    b"\r\n",
    b"1",
    b"-",
    b"0.5",
    b"e9",
    b"drive",
    b'"',
    b" ",
    b"nan",
    b"inf",
    b"\xff",
    b"\0",
    b"\xc2",
]
MAT_MAPPING = Mapping.model_validate(
    {
        "table": {"format": "mat"},
        "time": {"column": "t"},
        "input": {"column": "u", "kind": "torque_nm"},
        "output": {"column": "y", "kind": "position_rad"},
    }
)


def _read_or_refuse(read, name, content):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.write_bytes(content)
        try:
            return read(path)
        except NxtTwinError as caught:
            refusal = caught
    assert "\n" not in str(refusal)
    return None


@settings(max_examples=150, deadline=None)
@given(st.lists(st.sampled_from(SCRAPS), max_size=40).map(b"".join))
def test_any_rows_are_read_or_refused(rows):
    recording = _read_or_refuse(read_recording, "run.csv", HEADER + b"0,1,drive,0\n" + rows)
    if recording is not None:
        assert recording.rows >= 2
        assert np.all(np.diff(recording.time_s) >= 0.0)
        assert not np.isnan(recording.columns["a_power_pct"]).any()


@pytest.mark.parametrize("name", ["run.csv", "run.parquet"])
@settings(max_examples=50, deadline=None)
@given(st.binary(max_size=200))
def test_any_bytes_are_read_or_refused(name, content):
    _read_or_refuse(read_recording, name, content)


@settings(max_examples=100, deadline=None)
@given(st.text(alphabet="time:inputoc{}[]&*!|>-'\"#,% \n\t1.e", max_size=60))
def test_any_yaml_is_read_or_refused(text):
    _read_or_refuse(read_mapping, "mapping.yaml", text.encode())


@settings(max_examples=60, deadline=None)
@given(length=st.integers(0, 700))
def test_a_mat_file_that_was_cut_short_is_read_or_refused(length):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.mat"
        savemat(path, {name: np.arange(10.0) for name in "tuy"})
        content = path.read_bytes()[:length]
    _read_or_refuse(lambda path: read_mapped(path, MAT_MAPPING), "run.mat", content)


@pytest.mark.parametrize(
    "content",
    [
        HEADER + b"0,1,drive,0\n1,2,drive," + b"x" * 100_000,
        HEADER + b"0,1,drive,0\n1,2," + b"x" * 100_000 + b",0",
        HEADER[:-1] + b"x" * 100_000 + b"\n0,1,drive,0\n",
    ],
)
def test_an_overlong_cell_or_name_is_quoted_in_part(put, refusal, content):
    assert len(refusal(RecordingError, read_recording, put("run.csv", content))) < 400
