"""Reading Parquet recordings."""

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest

from nxt_twin.errors import RecordingError
from nxt_twin.recording.files import read_recording
from nxt_twin.recording.tables.floats import floats


@pytest.fixture
def put_parquet(tmp_path):
    def write(**columns):
        path = tmp_path / "run.parquet"
        pyarrow.parquet.write_table(pa.table(columns), path)
        return path

    return write


def test_reads_every_number_type_and_takes_nulls_and_nan_as_unsampled(put_parquet):
    path = put_parquet(
        time_s=pa.array([0.0, 0.5, 1.0]),
        a_power_pct=pa.array([None, 30, None], pa.int8()),
        a_mode=pa.array([None, "coast", None]).dictionary_encode(),
        a_tacho_deg=pa.array([0, None, 2], pa.int32()),
        battery_v=pa.array([float("nan"), 8.0, None], pa.float32()),
        s1_touch=pa.array([True, False, None]),
        s2_light_raw=pa.nulls(3),
    )
    columns = read_recording(path).columns
    np.testing.assert_array_equal(columns["a_power_pct"], [0, 30, 30])
    np.testing.assert_array_equal(columns["a_mode"], [0, 2, 2])
    np.testing.assert_array_equal(columns["a_tacho_deg"], [0, np.nan, 2])
    np.testing.assert_array_equal(columns["battery_v"], [np.nan, 8, np.nan])
    np.testing.assert_array_equal(columns["s1_touch"], [1, 0, np.nan])
    assert np.isnan(columns["s2_light_raw"]).all()


@pytest.mark.parametrize(
    ("columns", "parts"),
    [
        ({"a_tacho_deg": [1, 2]}, ["no column time_s"]),
        ({"time_s": [0.0]}, ["only one row"]),
        ({"time_s": [1.0, 0.0]}, ["row 2, column time_s", "backwards"]),
        ({"time_s": [0.0, None]}, ["row 2, column time_s", "no time stamp"]),
        ({"time_s": [0.0, 1.0], "a_power_pct": [0.0, float("inf")]}, ["row 2, column a_power_pct", "finite"]),
        ({"time_s": [0.0, 1.0], "a_power_pct": [0, -101]}, ["row 2, column a_power_pct", "-101 is outside"]),
        ({"time_s": [0.0, 1.0], "a_tacho_deg": ["0", "1"]}, ["column a_tacho_deg", "string, not numbers"]),
        ({"time_s": [0.0, 1.0], "a_mode": [0, 1]}, ["column a_mode", "not words"]),
        ({"time_s": [0.0, 1.0], "a_mode": ["drive", "stop"]}, ["row 2, column a_mode", "'stop'"]),
        ({"time_s": [0.0, 1.0], "b_tacho": [0, 1]}, ["unknown column 'b_tacho'", "b_tacho_deg"]),
    ],
)
def test_refuses_with_the_place_and_what_to_do(put_parquet, refusal, columns, parts):
    line = refusal(RecordingError, read_recording, put_parquet(**columns))
    for part in ["run.parquet", *parts]:
        assert part in line


def test_refuses_a_csv_named_parquet_and_a_damaged_file(put, put_parquet, refusal):
    line = refusal(RecordingError, read_recording, put("text.parquet", "time_s,a_tacho_deg\n0,1\n1,2\n"))
    assert "no readable Parquet file" in line
    path = put_parquet(time_s=np.arange(1000.0))
    path.write_bytes(path.read_bytes()[:-400])
    assert "no readable Parquet file" in refusal(RecordingError, read_recording, path)


def test_refuses_a_small_file_that_unfolds_to_too_much(tmp_path, refusal):
    path = tmp_path / "bomb.parquet"
    rows = pa.chunked_array([pa.nulls(2**20, pa.float64())] * 65)
    pyarrow.parquet.write_table(pa.table({"time_s": rows}), path)
    assert path.stat().st_size < 2**20
    assert "unfolds to 68157440 cells" in refusal(RecordingError, read_recording, path)


@pytest.mark.parametrize(
    "column",
    [
        pa.chunked_array([[1.0, None, 3.0], [], [None, 5.0]]),
        pa.chunked_array([[0, 1, None, 3, None, 5]]).slice(1),
        pa.chunked_array(
            [pa.array([9, 9, 1, None], pa.int8())[2:], pa.array([3.0, None, 5.0]).cast(pa.int8())]
        ),
    ],
)
def test_numbers_of_chunks_and_slices_are_those_that_pyarrow_itself_tells(column):
    expected = [np.nan if one is None else float(one) for one in column.to_pylist()]
    np.testing.assert_array_equal(floats(column), expected)


@pytest.mark.parametrize("column", [pa.chunked_array([], pa.float64()), pa.chunked_array([pa.nulls(2)])])
def test_a_column_without_numbers_is_nan(column):
    assert np.isnan(floats(column)).all()
    assert floats(column).shape == (len(column),)
