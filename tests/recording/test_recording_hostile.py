"""Whatever a file holds, it is read or refused in one line."""

import tempfile
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyarrow import feather
from scipy.io import savemat

from nxt_twin.api.files import read_recording as api_read_recording
from nxt_twin.errors import LONGEST_LINE, CaseError, MappingError, NxtTwinError, RecordingError
from nxt_twin.recording.case import read_case
from nxt_twin.recording.files import read_recording
from nxt_twin.recording.guess.guess import guess_mapping
from nxt_twin.recording.mapped import read_mapped
from nxt_twin.recording.mapping import Mapping, read_mapping

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
FEATHER_MAPPING = Mapping.model_validate(
    {
        "table": {"format": "feather"},
        "time": {"column": "t"},
        "input": {"column": "u", "kind": "torque_nm"},
        "output": {"column": "y", "kind": "position_rad"},
    }
)
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


def _mat(folder, values, **options):
    path = folder / "run.mat"
    savemat(path, dict.fromkeys("tuy", values), **options)
    return path


@pytest.mark.parametrize("length", [0, 100, 130, 300, 600])
def test_a_mat_file_that_was_cut_short_is_read_or_refused(tmp_path, length):
    content = _mat(tmp_path, np.arange(10.0)).read_bytes()[:length]
    _read_or_refuse(lambda path: read_mapped(path, MAT_MAPPING), "run.mat", content)


def test_a_mat_file_that_ends_its_reader_by_a_signal_is_refused(tmp_path, refusal):
    path = _mat(tmp_path, np.arange(10.0))
    content = bytearray(path.read_bytes())
    content[176] = 249  # scipy 1.17 reads beyond its memory there
    path.write_bytes(content)
    assert "is no readable MAT file" in refusal(RecordingError, read_mapped, path, MAT_MAPPING)


def test_a_mat_file_that_unfolds_to_the_whole_memory_is_refused(tmp_path, refusal):
    path = _mat(tmp_path, np.zeros(2_000_000, dtype=np.int8), do_compression=True)
    assert "unfolds to 6000000 cells" in refusal(RecordingError, read_mapped, path, MAT_MAPPING)


def test_a_parquet_file_that_says_one_long_word_in_every_row_is_refused(tmp_path, refusal):
    path = tmp_path / "run.parquet"
    modes = pa.DictionaryArray.from_arrays(np.zeros(100, np.int32), ["x" * 30_000_000])
    table = pa.table({"time_s": np.arange(100.0), "a_mode": modes})
    pyarrow.parquet.write_table(table, path, compression="zstd")
    assert path.stat().st_size < 14_000
    assert "unfolds to" in refusal(RecordingError, read_recording, path)


def test_a_parquet_file_that_repeats_one_row_for_ever_is_refused(tmp_path, refusal):
    path = tmp_path / "run.parquet"
    pyarrow.parquet.write_table(pa.table({"time_s": np.zeros(2_000_000)}), path)
    assert path.stat().st_size < 10_000
    assert "unfolds to 2000000 cells" in refusal(RecordingError, read_recording, path)


def test_a_parquet_file_with_half_a_character_is_refused_with_its_column(tmp_path, refusal):
    path = tmp_path / "run.parquet"
    words = pa.StringArray.from_buffers(
        2, pa.py_buffer(np.array([0, 5, 6], np.int32)), pa.py_buffer(b"driv\xe5x")
    )
    pyarrow.parquet.write_table(pa.table({"time_s": [0.0, 0.1], "a_mode": words}), path)
    assert "column a_mode: holds text that is not UTF-8" in refusal(RecordingError, read_recording, path)


def test_a_feather_file_with_one_damaged_byte_is_read_or_refused(tmp_path):
    t = np.arange(30) / 100
    whole, damaged = tmp_path / "whole.feather", tmp_path / "damaged.feather"
    feather.write_feather(pa.table({"t": t, "u": t, "y": t}), str(whole), compression="uncompressed")
    content, said = whole.read_bytes(), set()
    for place in range(0, len(content), 2):
        changed = bytearray(content)
        changed[place] ^= 0xFF
        damaged.write_bytes(changed)
        try:
            read_mapped(damaged, FEATHER_MAPPING)
        except NxtTwinError as refused:
            said.add(str(refused))
    assert said


def test_a_table_whose_gain_leaves_no_number_is_refused(put, refusal):
    path = put("run.csv", "t,u,y\n0,1,1e308\n0.1,1,2e307\n")
    output = {"column": "y", "kind": "position_rad", "gain": 35.0}
    plain = MAT_MAPPING.model_dump(exclude={"table", "output"}, exclude_none=True)
    mapping = Mapping.model_validate({**plain, "output": output})
    assert "output: becomes larger than a number can be" in refusal(
        RecordingError, read_mapped, path, mapping
    )


LAUGHS = "a0: &a0 [x,x,x,x,x,x,x,x,x]\n" + "".join(
    f"a{n}: &a{n} [{','.join([f'*a{n - 1}'] * 9)}]\n" for n in range(1, 9)
)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (LAUGHS + "input: *a8\n", "unfold to more than 100000 values"),
        ("a: &a {x: 1}\nb: &b {<<: [*a,*a,*a,*a]}\ninput: &c [*c]", "refers to itself"),
        ("input: " + "[" * 65 + "]" * 65, "nested more than 64 deep"),
        ("- " * 5000, "nested more than 64 deep"),
        ("input: " + "9" * 500, "a number has 500 characters"),
        ("input: 0x" + "f" * 100, "a whole number is beyond"),
        ("input: {kind: " + "9" * 60 + "}", "a whole number is beyond"),
        ("input: !!timestamp soon", "a value is not what its tag says"),
        ("input: !!bool perhaps", "a value is not what its tag says"),
        ("input: !!int ''", "a value is not what its tag says"),
        ("input: " + "1:" * 300 + "1", "a number has 601 characters"),
    ],
)
def test_yaml_that_unfolds_or_nests_without_end_is_refused(put, refusal, text, why):
    assert why in refusal(MappingError, read_mapping, put("mapping.yaml", text))


def test_yaml_may_say_a_thing_once_and_mean_it_twice(put):
    text = "time: &t {column: t, unit: s}\ninput: {column: u, kind: torque_nm}\n"
    path = put("mapping.yaml", text + "output: {column: y, kind: position_rad}\nsupply: null\n")
    assert read_mapping(path).time.column == "t"
    path = put("merged.yaml", text + "output: {<<: {column: y, kind: position_rad}}\n")
    assert read_mapping(path).output.column == "y"


@pytest.mark.parametrize("digits", [400, 5000])
def test_a_json_number_without_end_is_refused_with_its_row(put, refusal, digits):
    row = '{{"t": {}, "u": 1, "y": {}}}\n'
    table = put("run.json", row.format(0, 1) + row.format(1, "9" * digits) + row.format(2, 1))
    json_mapping = Mapping.model_validate(
        MAT_MAPPING.model_dump(exclude_none=True) | {"table": {"format": "json"}}
    )
    assert "row 2" in refusal(RecordingError, read_mapped, table, json_mapping)


def test_what_is_quoted_in_an_error_is_quoted_in_part(put, refusal):
    nested = "{a: [1, 2, {b: " + "[" * 40 + "]" * 40 + "}]}"
    for content in (f"time: {nested}", f"{'k' * 900_000}: 1", f"time: {{unit: {'m' * 900_000}}}"):
        assert len(refusal(MappingError, read_mapping, put("mapping.yaml", content))) <= LONGEST_LINE


@given(st.text(max_size=2000), st.text(max_size=2000), st.text(max_size=2000))
def test_an_error_is_one_line_of_bounded_length(where, what, mend):
    line = str(NxtTwinError(what, where=where, mend=mend))
    assert len(line) <= LONGEST_LINE
    assert not set(line) & {"\n", "\r", "\t"}


def test_of_a_long_place_the_end_is_told_and_short_parts_are_whole():
    line = str(NxtTwinError("is empty", where="/folder" * 100 + ", row 7", mend="look"))
    assert line.startswith("…")
    assert line.endswith("/folder, row 7: is empty (look)")
    assert len(line) == LONGEST_LINE


def test_a_case_that_lists_a_hundred_thousand_files_is_refused_at_once(put, refusal):
    names = "".join(f"- r{n}\n" for n in range(100_000))
    path = put("case/case.yaml", f"plant: nxt_motor\nrecordings:\n{names}- r7\n")
    assert "lists r7 twice" in refusal(CaseError, read_case, path.parent)


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


def test_a_loop_of_links_is_refused(tmp_path):
    loop = tmp_path / "loop.csv"
    loop.symlink_to(loop)
    with pytest.raises(RecordingError, match="cannot be read"):
        read_recording(loop)


def test_no_name_at_all_is_a_folder():
    with pytest.raises(RecordingError, match="is a folder where a file is expected"):
        api_read_recording("")


def test_a_table_of_one_row_is_told_as_such(put):
    with pytest.raises(RecordingError, match=r"holds only one row .record at least two"):
        guess_mapping(put("one.csv", "t,pwm,deg\n0,50,0\n"))


def test_a_table_of_nothing_but_a_header_is_told_as_such(put):
    with pytest.raises(RecordingError, match=r"holds no rows .record at least two"):
        guess_mapping(put("none.csv", "t,pwm,deg\n"))
