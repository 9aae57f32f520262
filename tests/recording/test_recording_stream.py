"""Recordings that grow, and what a crash leaves of them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import numpy as np
import pytest

from nxt_twin.errors import RecordingError
from nxt_twin.recording.files import read_recording
from nxt_twin.recording.stream import BATCH_S, RecordingWriter, recover, stream_path

COLUMNS = ("time_s", "a_power_pct", "a_mode", "a_tacho_deg", "battery_v", "s1_touch")

KILLED = """
import sys, time
from pathlib import Path
from nxt_twin.recording.stream import RecordingWriter
writer = RecordingWriter(Path(sys.argv[1]), ("time_s", "a_tacho_deg"))
number = 0
while True:
    writer.row({"time_s": number / 100, "a_tacho_deg": float(number)})
    number += 1
    if number == 1000:
        print("go on", flush=True)
        sys.stdin.readline()
"""


def rows(count: int, period_s: float = 0.01):
    for number in range(count):
        row = {"time_s": number * period_s, "a_power_pct": 40.0, "a_mode": 2.0, "a_tacho_deg": float(number)}
        yield {**row, "battery_v": 8.1} if number % 50 == 0 else row


def test_what_was_written_is_read_back_and_the_stream_is_gone(tmp_path):
    path = tmp_path / "run.parquet"
    with RecordingWriter(path, COLUMNS) as writer:
        for row in rows(120):
            writer.row(row)
    recording = read_recording(path)
    assert recording.rows == 120
    np.testing.assert_array_equal(recording.columns["a_tacho_deg"], np.arange(120.0))
    assert set(recording.columns["a_mode"]) == {2.0}
    assert np.isnan(recording.columns["battery_v"]).sum() == 117
    assert "s1_touch" not in recording.columns
    assert [each.name for each in tmp_path.iterdir()] == ["run.parquet"]


def test_a_recording_may_be_csv(tmp_path):
    path = tmp_path / "run.csv"
    with RecordingWriter(path, COLUMNS) as writer:
        for row in rows(3):
            writer.row(row)
    assert path.read_text().splitlines()[1] == "0,40,coast,0,8.1"


def test_what_is_on_disk_is_never_more_than_half_a_second_behind(tmp_path):
    path = tmp_path / "run.parquet"
    writer = RecordingWriter(path, COLUMNS)
    for row in rows(1000):
        writer.row(row)
    copy = tmp_path / "copy.parquet.stream"
    copy.write_bytes(stream_path(path).read_bytes())
    assert recover(copy).time_s[-1] >= 9.99 - BATCH_S - 0.01
    writer.finish()


def test_a_program_that_is_killed_leaves_all_but_the_last_moments(tmp_path):
    path = tmp_path / "run.parquet"
    with subprocess.Popen(
        [sys.executable, "-c", KILLED, str(path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        assert process.stdout.readline() == b"go on\n"
        os.kill(process.pid, signal.SIGKILL)
    assert process.returncode == -signal.SIGKILL
    assert not path.exists()
    recovered = recover(path)
    assert recovered.time_s[-1] >= 9.99 - 1.0
    np.testing.assert_array_equal(read_recording(path).columns["a_tacho_deg"], np.arange(recovered.rows))
    assert not stream_path(path).exists()


@pytest.mark.parametrize("share", [0.2, 0.5, 0.77, 0.999])
def test_a_stream_cut_anywhere_gives_its_whole_batches(tmp_path, share):
    path = tmp_path / "run.parquet"
    writer = RecordingWriter(path, COLUMNS)
    for row in rows(1000):
        writer.row(row)
    data = stream_path(path).read_bytes()
    writer.finish()
    cut = tmp_path / "cut.parquet.stream"
    cut.write_bytes(data[: int(share * len(data))])
    recovered = recover(cut)
    np.testing.assert_array_equal(recovered.columns["a_tacho_deg"], np.arange(recovered.rows))
    assert recovered.rows >= int(share * 1000) - 2 * 51


def test_nothing_to_recover_is_said(tmp_path):
    with pytest.raises(RecordingError, match="nothing to recover"):
        recover(tmp_path / "run.parquet")
    (tmp_path / "run.parquet.stream").write_bytes(b"\xff\xff\xff\xff\x10")
    with pytest.raises(RecordingError, match="nothing in it is whole"):
        recover(tmp_path / "run.parquet")


def test_no_recording_is_written_over(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("mine")
    with pytest.raises(RecordingError, match="there already"):
        RecordingWriter(path, COLUMNS)
    path.unlink()
    stream_path(path).write_bytes(b"x")
    with pytest.raises(RecordingError, match="nxt-twin recover"):
        RecordingWriter(path, COLUMNS)


def test_what_no_recording_has_is_refused(tmp_path):
    with pytest.raises(RecordingError, match="unknown column"):
        RecordingWriter(tmp_path / "run.csv", ("time_s", "speed"))
    with pytest.raises(RecordingError, match="suffix"):
        RecordingWriter(tmp_path / "run.txt", ("time_s",))
    with (
        RecordingWriter(tmp_path / "run.csv", ("time_s",)) as writer,
        pytest.raises(RecordingError, match="announced"),
    ):
        writer.row({"time_s": 0.0, "battery_v": 8.0})


def test_a_recording_without_rows_is_none(tmp_path):
    with RecordingWriter(tmp_path / "run.csv", ("time_s",)) as writer:
        pass
    assert writer.finish() is None
    assert not list(tmp_path.iterdir())
