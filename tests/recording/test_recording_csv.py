"""Reading CSV recordings: what is read, what is data, and what is refused with its line."""

import os

import numpy as np
import pytest

from nxt_twin.errors import RecordingError
from nxt_twin.recording.files import read_recording

HEADER = "time_s,a_power_pct,a_mode,a_tacho_deg,battery_v\n"


def test_reads_numbers_words_and_unsampled_cells(put):
    path = put("run.csv", HEADER + "0.0,50,float,0,8.1\n0.01,-20,brake,3,\n")
    recording = read_recording(path)
    assert recording.name == "run.csv"
    assert recording.kinds is None
    np.testing.assert_array_equal(recording.time_s, [0.0, 0.01])
    np.testing.assert_array_equal(recording.columns["a_power_pct"], [50.0, -20.0])
    np.testing.assert_array_equal(recording.columns["a_mode"], [1.0, 3.0])
    np.testing.assert_array_equal(recording.columns["battery_v"], [8.1, np.nan])


def test_an_empty_command_means_unchanged_and_zero_before_the_first(put):
    text = "time_s,a_power_pct,a_mode,a_tacho_deg\n0,,,0\n1,40,coast,0\n2,,,\n3,-10,brake,5\n4,,,6\n"
    recording = read_recording(put("run.csv", text))
    np.testing.assert_array_equal(recording.columns["a_power_pct"], [0, 40, 40, -10, -10])
    np.testing.assert_array_equal(recording.columns["a_mode"], [0, 2, 2, 3, 3])
    np.testing.assert_array_equal(recording.columns["a_tacho_deg"], [0, 0, np.nan, 5, 6])


def test_gaps_and_repeated_stamps_are_data(put):
    recording = read_recording(put("run.csv", "time_s,a_tacho_deg\n0,0\n0.1,1\n0.1,1\n60,2\n"))
    np.testing.assert_array_equal(recording.time_s, [0.0, 0.1, 0.1, 60.0])


@pytest.mark.parametrize(
    "text",
    [
        "\ufefftime_s,a_tacho_deg\n0,1\n1,2\n",
        "time_s,a_tacho_deg\r\n0,1\r\n1,2\r\n",
        "time_s, a_tacho_deg\n0, 1\n1, 2\n",
        "\n\ntime_s,a_tacho_deg\n\n0,1\n\n1,2\n\n   \n",
        '"time_s","a_tacho_deg"\n"0","1"\n"1","2"\n',
        "time_s,a_tacho_deg\n0,+1\n1,2.0",
    ],
)
def test_reads_what_spreadsheets_and_editors_make_of_a_csv(put, text):
    recording = read_recording(put("run.csv", text))
    np.testing.assert_array_equal(recording.time_s, [0.0, 1.0])
    np.testing.assert_array_equal(recording.columns["a_tacho_deg"], [1.0, 2.0])


def test_blank_cells_count_as_unsampled(put):
    recording = read_recording(put("run.csv", "time_s,a_tacho_deg,battery_v\n0,1,  \n1, ,8\n"))
    np.testing.assert_array_equal(recording.columns["a_tacho_deg"], [1.0, np.nan])
    np.testing.assert_array_equal(recording.columns["battery_v"], [np.nan, 8.0])


def test_reads_sensor_and_rig_columns(put):
    text = "time_s,s4_ultrasonic_cm,s1_light_raw,s2_sound_raw,s3_touch,rig_distance_mm\n"
    recording = read_recording(put("run.csv", text + "0,255,1023,0,1,300.5\n1,30,,,,301\n"))
    np.testing.assert_array_equal(recording.columns["s4_ultrasonic_cm"], [255.0, 30.0])
    np.testing.assert_array_equal(recording.columns["rig_distance_mm"], [300.5, 301.0])


def test_the_sidecar_names_the_plant_and_may_hold_anything_else(put):
    put("run.yaml", "plant: nxt_motor\nweather: fine\n")
    assert read_recording(put("run.csv", "time_s,a_tacho_deg\n0,1\n1,2\n")).plant == "nxt_motor"


def test_without_a_sidecar_no_plant_is_named(put):
    assert read_recording(put("run.csv", "time_s,a_tacho_deg\n0,1\n1,2\n")).plant is None


ROWS = "0.00,10,drive,0,8.0\n0.01,10,drive,1,8.0\n"


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("", ["is empty"]),
        ("  \n\n", ["nothing but blanks"]),
        (HEADER, ["no rows", "at least two"]),
        (HEADER + "0.00,10,drive,0,8.0\n", ["only one row"]),
        ("a_power_pct,a_tacho_deg\n1,2\n3,4\n", ["no column time_s"]),
        ("time_s,a_tacho_degree\n0,2\n3,4\n", ["unknown column 'a_tacho_degree'", "a_tacho_deg"]),
        ("time_s;a_tacho_deg\n0;2\n3;4\n", ["unknown column", "commas"]),
        ("time_s,input,output\n0,2,1\n3,4,1\n", ["unknown column 'input'", "mapping file"]),
        ("time_s,a_tacho_deg,a_tacho_deg\n0,2,1\n3,4,1\n", ["column a_tacho_deg", "twice"]),
        (HEADER + ROWS + "0.005,10,drive,1,8.0\n", ["row 4, column time_s", "backwards", "0.01 to 0.005"]),
        (HEADER + ROWS + ",10,drive,1,8.0\n", ["row 4, column time_s", "no time stamp"]),
        (HEADER + ROWS + "nan,10,drive,1,8.0\n", ["row 4, column time_s", "no finite number"]),
        (HEADER + ROWS + "0.02,inf,drive,1,8.0\n", ["row 4, column a_power_pct", "'inf'", "finite"]),
        (
            HEADER + ROWS + "0.02,nan,drive,1,8.0\n",
            ["row 4, column a_power_pct", "'nan'", "leave the cell empty"],
        ),
        (HEADER + ROWS + "0.02,1e999,drive,1,8.0\n", ["row 4, column a_power_pct", "finite"]),
        (HEADER + ROWS + "0.02,10,drive,three,8.0\n", ["row 4, column a_tacho_deg", "'three' is no number"]),
        (HEADER + ROWS + "0.02,10,drive,1_0,8.0\n", ["row 4, column a_tacho_deg", "'1_0'"]),
        (
            HEADER + ROWS + "0.02,100.5,drive,1,8.0\n",
            ["row 4, column a_power_pct", "100.5 is outside -100 to 100"],
        ),
        (
            HEADER + ROWS + "0.02,10,drove,1,8.0\n",
            ["row 4, column a_mode", "'drove'", "nearest known: drive"],
        ),
        (HEADER + ROWS + "0.02,10,drive,1\n", ["row 4", "4 cells where there are 5 columns"]),
        (HEADER + ROWS + "0.02,10,drive,1,8,9\n", ["row 4", "6 cells where there are 5 columns"]),
        ("time_s,s1_touch\n0,0\n1,2\n", ["row 3, column s1_touch", "outside 0 to 1"]),
        ("time_s,s1_ultrasonic_cm\n0,0\n1,256\n", ["row 3", "outside 0 to 255"]),
        ("time_s,s1_light_raw\n0,0\n1,1024\n", ["row 3", "outside 0 to 1023"]),
        ('time_s,a_tacho_deg\n0,"2\n' + "3,4\n" * 40000, ["is no text table", "quote"]),
    ],
)
def test_refuses_with_the_place_and_what_to_do(put, refusal, text, parts):
    path = put("run.csv", text)
    line = refusal(RecordingError, read_recording, path)
    assert str(path) in line
    for part in parts:
        assert part in line


def test_counts_rows_as_an_editor_does_blank_lines_included(put, refusal):
    text = "\ntime_s,a_power_pct,a_tacho_deg\n\n0,1,1\n\n\n1,200,1\n2,1,1\n"
    assert "row 7, column a_power_pct" in refusal(RecordingError, read_recording, put("run.csv", text))


@pytest.mark.parametrize(
    ("content", "part"),
    [
        (
            b"time_s,a_tacho_deg\n0,1\n1,\xff\xfe\n",
            "row 3: is not UTF-8 text (save it as CSV UTF-8, or read it through a mapping",
        ),
        (b"time_s,a_tacho\xe9\n0,1\n1,2\n", "row 1: is not UTF-8"),
        ("time_s,a_tacho_deg\n0,1\n1,2\n".encode("utf-16"), "UTF-16"),
        (b"PAR1\x15\x04", "Parquet file"),
        (b"PK\x03\x04\x14\x00", "spreadsheet"),
        (b"MATLAB 5.0 MAT-file, Platform", "MAT file"),
        (b"\x7fELF\x02\x01\x01\x00\x00", "binary"),
    ],
)
def test_refuses_what_is_no_utf8_text(put, refusal, content, part):
    assert part in refusal(RecordingError, read_recording, put("run.csv", content))


def test_refuses_a_missing_file_a_folder_and_a_pipe(tmp_path, refusal):
    (tmp_path / "folder.csv").mkdir()
    os.mkfifo(tmp_path / "pipe.csv")
    assert "no such file" in refusal(RecordingError, read_recording, tmp_path / "none.csv")
    assert "is a folder where a file is expected" in refusal(
        RecordingError, read_recording, tmp_path / "folder.csv"
    )
    assert "no ordinary file" in refusal(RecordingError, read_recording, tmp_path / "pipe.csv")
    assert "file name" in refusal(RecordingError, read_recording, tmp_path / "nul\0.csv")


def test_refuses_a_path_through_a_file(put, refusal):
    path = put("run.csv", "time_s\n")
    assert "cannot be read: Not a directory" in refusal(RecordingError, read_recording, path / "more.csv")


def test_refuses_a_file_over_the_limit_unread(tmp_path, refusal):
    path = tmp_path / "huge.csv"
    with path.open("wb") as file:
        file.truncate(2 * 2**30)
    line = refusal(RecordingError, read_recording, path)
    assert "2048 MiB, over the limit of 512 MiB" in line
    assert "split it" in line


def test_refuses_another_suffix(put, refusal):
    line = refusal(RecordingError, read_recording, put("run.xlsx", "time_s\n"))
    assert "neither .csv nor .parquet" in line


@pytest.mark.parametrize(
    ("sidecar", "part"),
    [
        ("plant: [1, 2\n", "line 2"),
        ("plant: 5\n", "key plant"),
        ("just words\n", "key: value"),
        ("plant: !!python/object/apply:os.getcwd []\n", "line 1"),
    ],
)
def test_refuses_a_sidecar_that_is_none(put, refusal, sidecar, part):
    path = put("run.csv", "time_s,a_tacho_deg\n0,1\n1,2\n")
    put("run.yaml", sidecar)
    line = refusal(RecordingError, read_recording, path)
    assert "run.yaml" in line
    assert part in line


def test_a_leap_of_the_clock_is_refused_with_its_row(put, refusal):
    path = put("run.csv", "time_s,a_power_pct,a_tacho_deg\n0,1,0\n0.01,1,0\n1e9,1,0\n")
    line = refusal(RecordingError, read_recording, path)
    assert "row 4, column time_s: time leaps by 1e+09 s, more than 3600 s" in line
    slow = put("slow.csv", "time_s,a_power_pct,a_tacho_deg\n1.7e9,1,0\n1700003600,1,0\n")
    assert read_recording(slow).duration_s == 3600.0
