"""What is written is read back the same."""

import tempfile
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nxt_twin.errors import RecordingError
from nxt_twin.recording.checks import LONGEST_GAP_S
from nxt_twin.recording.columns import CATALOGUE
from nxt_twin.recording.files import read_recording, write_recording
from nxt_twin.recording.mapped import read_mapped
from nxt_twin.recording.mapping import Mapping
from nxt_twin.recording.recording import Recording, SignalKinds


def _values(name):
    column = CATALOGUE[name]
    if column.words:
        return st.integers(0, len(column.words) - 1).map(float)
    low, high = max(column.lowest, -1e9), min(column.highest, 1e9)
    number = st.one_of(st.floats(low, high), st.integers(int(low), int(high)).map(float))
    return number if column.role in ("command", "stamp") else st.one_of(number, st.just(float("nan")))


@st.composite
def recordings(draw):
    rows = draw(st.integers(2, 12))
    names = draw(st.lists(st.sampled_from(sorted(set(CATALOGUE) - {"time_s"})), unique=True, max_size=6))
    gaps = draw(st.lists(st.floats(0.0, 0.9 * LONGEST_GAP_S), min_size=rows - 1, max_size=rows - 1))
    columns = {"time_s": draw(_values("time_s")) + np.cumsum([0.0, *gaps])}
    for name in names:
        columns[name] = np.array(draw(st.lists(_values(name), min_size=rows, max_size=rows)))
    return Recording("run", columns)


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
@settings(max_examples=60, deadline=None)
@given(recording=recordings())
def test_write_then_read_is_identical(suffix, recording):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"run{suffix}"
        write_recording(recording, path)
        back = read_recording(path)
    assert set(back.columns) == set(recording.columns)
    for name, values in recording.columns.items():
        np.testing.assert_array_equal(back.columns[name], values)


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
@settings(max_examples=20, deadline=None)
@given(output=st.lists(st.floats(-1e6, 1e6), min_size=3, max_size=9))
def test_a_mapped_recording_is_written_and_read_back_through_a_mapping(suffix, output):
    rows = len(output)
    columns = {
        "time_s": np.arange(rows) * 1e-3,
        "input": np.linspace(-3.3, 7.1, rows),
        "output": np.array(output),
        "supply_v": np.where(np.arange(rows) == 1, np.nan, 8.05),
    }
    recording = Recording("run", columns, SignalKinds("force_n", "position_m"))
    mapping = Mapping.model_validate(
        {
            "table": {"format": suffix},
            "time": {"column": "time_s"},
            "input": {"column": "input", "kind": "force_n"},
            "output": {"column": "output", "kind": "position_m"},
            "supply": {"column": "supply_v"},
        }
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"run.{suffix}"
        write_recording(recording, path)
        back = read_mapped(path, mapping)
    assert back.kinds == recording.kinds
    for name, values in columns.items():
        np.testing.assert_array_equal(back.columns[name], values)


def test_a_csv_is_what_a_person_would_write(tmp_path):
    columns = {
        "time_s": np.array([0.0, 0.012345]),
        "a_power_pct": np.array([50.0, -100.0]),
        "a_mode": np.array([0.0, 3.0]),
        "a_tacho_deg": np.array([np.nan, 12.0]),
        "battery_v": np.array([8.25, np.nan]),
    }
    write_recording(Recording("run", columns), tmp_path / "run.csv")
    assert (tmp_path / "run.csv").read_text() == (
        "time_s,a_power_pct,a_mode,a_tacho_deg,battery_v\n0,50,drive,,8.25\n0.012345,-100,brake,12,\n"
    )


def test_parquet_holds_integers_words_and_nulls(tmp_path):
    columns = {
        "time_s": np.array([0.0, 0.5]),
        "a_mode": np.array([1.0, np.nan]),
        "a_tacho_deg": np.array([np.nan, 12.0]),
    }
    write_recording(Recording("run", columns), tmp_path / "run.parquet")
    table = pyarrow.parquet.read_table(tmp_path / "run.parquet")
    assert table.to_pydict() == {"time_s": [0.0, 0.5], "a_mode": ["float", None], "a_tacho_deg": [None, 12]}
    assert table.schema.field("a_tacho_deg").type == "int64"


def _recording():
    return Recording("run", {"time_s": np.array([0.0, 1.0]), "a_tacho_deg": np.array([0.0, 1.0])})


def test_a_failed_write_leaves_neither_half_a_file_nor_a_changed_one(tmp_path, refusal):
    (tmp_path / "run.csv").mkdir()
    line = refusal(RecordingError, write_recording, _recording(), tmp_path / "run.csv")
    assert "cannot be written" in line
    assert [path.name for path in tmp_path.iterdir()] == ["run.csv"]


def test_writing_replaces_the_old_file_and_leaves_the_sidecar_alone(put, tmp_path):
    put("run.csv", "old")
    put("run.yaml", "plant: mine\n")
    write_recording(_recording(), tmp_path / "run.csv")
    assert read_recording(tmp_path / "run.csv").plant == "mine"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.csv", "run.yaml"]


@pytest.mark.parametrize(
    ("name", "part"),
    [("none/run.csv", "cannot be written: No such file"), ("file/run.csv", "cannot be written: Not a dir")],
)
def test_refuses_a_place_that_cannot_be_written(put, tmp_path, refusal, name, part):
    put("file", "")
    assert part in refusal(RecordingError, write_recording, _recording(), tmp_path / name)


def test_refuses_to_write_another_suffix(tmp_path, refusal):
    line = refusal(RecordingError, write_recording, _recording(), tmp_path / "run.xlsx")
    assert "neither .csv nor .parquet" in line
