"""Recordings that grow, and what a crash leaves of them."""

from __future__ import annotations

import errno
import os
import re
import signal
import struct
import subprocess
import sys
import zlib
from dataclasses import FrozenInstanceError
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from nxt_twin.errors import RecordingError
from nxt_twin.recording.files import read_recording, read_sidecar
from nxt_twin.recording.frames import framed
from nxt_twin.recording.lags import KnownLags, RowLags
from nxt_twin.recording.stream import RecordingWriter, recover, stream_path

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
        assert writer.finish() == path
    assert writer.finish() == path  # again, which does nothing
    recording = read_recording(path)
    assert recording.rows == 120
    np.testing.assert_array_equal(recording.columns["a_tacho_deg"], np.arange(120.0))
    assert set(recording.columns["a_mode"]) == {2.0}
    assert np.isnan(recording.columns["battery_v"]).sum() == 117
    assert "s1_touch" not in recording.columns
    assert [each.name for each in tmp_path.iterdir()] == ["run.parquet"]


@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="asks /proc for a handle's file")
def test_a_recording_and_its_folder_are_on_the_disk_before_the_stream_goes(tmp_path, monkeypatch):
    path, synced = tmp_path / "run.csv", []

    def noted(handle):
        name = Path(f"/proc/self/fd/{handle}").readlink().name
        synced.append((name, path.exists(), stream_path(path).exists()))

    with RecordingWriter(path, COLUMNS) as writer:
        for row in rows(5):
            writer.row(row)
        monkeypatch.setattr(os, "fsync", noted)
    (stream, *_), (partial, *then), folder = synced
    assert stream == stream_path(path).name
    assert (partial.endswith(".partial"), then) == (True, [False, True])
    assert folder == (tmp_path.name, True, True)
    assert not stream_path(path).exists()


def test_a_recording_may_be_csv(tmp_path):
    path = tmp_path / "run.csv"
    with RecordingWriter(path, COLUMNS) as writer:
        for row in rows(3):
            writer.row(row)
    assert path.read_text().splitlines()[1] == "0,40,coast,0,8.1"


def begun(path, count=1000):
    """A stream as it is on disk after so many rows, with nobody writing it."""
    with RecordingWriter(path, COLUMNS) as writer:
        for row in rows(count):
            writer.row(row)
        data = stream_path(path).read_bytes()
    path.unlink(missing_ok=True)
    return data


@pytest.mark.parametrize("period_s", [0.001, 0.01, 30.0])
def test_a_row_is_on_its_way_to_the_disk_as_soon_as_it_was_read(tmp_path, period_s):
    path = tmp_path / "run.parquet"
    with RecordingWriter(path, COLUMNS) as writer:
        for number, row in enumerate(rows(30, period_s), 1):
            writer.row(row)
            copy = tmp_path / f"copy{number}.parquet.stream"
            copy.write_bytes(stream_path(path).read_bytes())
            assert recover(copy).recording.rows == number


def test_a_program_that_is_killed_leaves_every_row(tmp_path):
    path = tmp_path / "run.parquet"
    with subprocess.Popen(
        [sys.executable, "-c", KILLED, str(path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        assert process.stdout.readline() == b"go on\n"
        with pytest.raises(RecordingError, match="is being written"):
            recover(path)
        os.kill(process.pid, signal.SIGKILL)
    assert process.returncode == -signal.SIGKILL
    assert not path.exists()
    recovered = recover(path).recording
    assert recovered.rows == 1000
    np.testing.assert_array_equal(read_recording(path).columns["a_tacho_deg"], np.arange(1000.0))
    assert not stream_path(path).exists()


def test_what_a_killed_program_learnt_of_its_stamps_is_in_the_sidecar(tmp_path):
    path, lags = tmp_path / "run.parquet", RowLags()
    writer = RecordingWriter(path, COLUMNS)
    writer.keep_lags(lags)
    assert read_sidecar(path) == {"pulse_steps": 125}
    for row in rows(10):
        lags.taken("a", row["time_s"] - 0.004, 1e-4)
        lags.row(row["time_s"])
        writer.row(row)
    assert KnownLags(read_sidecar(path)).read_before_s("a") == (pytest.approx(0.004), pytest.approx(1e-4))
    writer.finish()
    assert read_recording(path).pulse_steps == 125


def test_a_recording_that_came_to_nothing_leaves_no_sidecar(tmp_path):
    with RecordingWriter(tmp_path / "run.csv", COLUMNS) as writer:
        writer.keep_lags(RowLags())
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("left", [0.2, 0.5, 0.77, 0.999])
def test_a_stream_cut_anywhere_gives_its_whole_rows(tmp_path, left):
    data = begun(tmp_path / "run.parquet")
    cut = tmp_path / "cut.parquet.stream"
    cut.write_bytes(data[: int(left * len(data))])
    recovered = recover(cut)
    assert recovered.damages == ()
    np.testing.assert_array_equal(
        recovered.recording.columns["a_tacho_deg"], np.arange(float(recovered.recording.rows))
    )
    assert recovered.recording.rows >= int(left * 1000) - 5
    assert not cut.exists()


def test_zeros_that_a_power_cut_left_at_the_end_are_no_damage(tmp_path):
    cut = tmp_path / "cut.parquet.stream"
    cut.write_bytes(begun(tmp_path / "run.parquet", 50) + bytes(4000))
    assert recover(cut).damages == ()
    assert read_recording(tmp_path / "cut.parquet").rows == 50


def test_one_flipped_bit_is_told_and_nothing_wrong_comes_back(tmp_path):
    data = begun(tmp_path / "run.parquet", 20)
    begins = [found.start() for found in re.finditer(b"NXTr", data)]
    damaged = tmp_path / "damaged.parquet.stream"
    for place in range(0, 8 * len(data), 37):  # every bit of a byte in turn, some 300 bits of all rows
        flipped = bytearray(data)
        flipped[place // 8] ^= 1 << place % 8
        damaged.write_bytes(flipped)
        recovered = recover(damaged)
        assert recovered.damages[0] == f"damaged at byte {max(at for at in begins if at <= place // 8)}"
        counts = recovered.recording.columns["a_tacho_deg"]
        assert set(counts) <= set(range(20))
        assert np.all(np.diff(counts) > 0.0)
        assert ("no row is lost" in recovered.damages[1]) == (counts.size == 20)
        assert damaged.read_bytes() == flipped
        (tmp_path / "damaged.parquet").unlink()


@pytest.mark.parametrize(
    "head",
    [
        b"\xff\xfe",
        b"[" * 100_000,
        b'{"format": "nxt-twin/stream/1", "columns": ["time_s", "\xff"]}',
        b'{"format": ' + b"9" * 5000,
        b'{"format": "nxt-twin/stream/1", "columns": 3}',
    ],
)
def test_names_that_are_damaged_are_refused_and_the_stream_is_kept(tmp_path, head):
    stream = tmp_path / "run.csv.stream"
    stream.write_bytes(2 * framed(0, head) + framed(1, bytes(16)))
    with pytest.raises(RecordingError, match=r"its beginning is damaged, .*the stream is kept"):
        recover(stream)
    assert [path.name for path in tmp_path.iterdir()] == ["run.csv.stream"]


@pytest.mark.parametrize("length", [0, 41, 2**31, 2**32 - 1])
@pytest.mark.parametrize("checked", [False, True])
def test_a_damaged_length_takes_one_row_and_no_memory(tmp_path, length, checked):
    data = bytearray(begun(tmp_path / "run.parquet", 20))
    head = data.index(b"NXTr", data.index(b"NXTr", 1) + 1) + 7 * (20 + 8 * len(COLUMNS))
    data[head + 8 : head + 12] = struct.pack("<I", length)
    if checked:
        data[head + 16 : head + 20] = struct.pack("<I", zlib.crc32(data[head : head + 16]))
    (tmp_path / "damaged.csv.stream").write_bytes(data)
    recovered = recover(tmp_path / "damaged.csv")
    assert recovered.damages == (f"damaged at byte {head}", "rows lost: 8")
    assert recovered.recording.rows == 19


def test_which_rows_are_lost_is_told(tmp_path):
    data = bytearray(begun(tmp_path / "run.parquet", 20))
    head, size = data.index(b"NXTr", data.index(b"NXTr", 1) + 1), 20 + 8 * len(COLUMNS)
    data[head + 7 * size + 25] ^= 4
    data[head + 8 * size + 2] ^= 4
    data[head + 12 * size + 5] ^= 4
    (tmp_path / "damaged.csv.stream").write_bytes(data)
    recovered = recover(tmp_path / "damaged.csv")
    assert recovered.damages == (
        f"damaged at byte {head + 7 * size}, byte {head + 12 * size}",
        "rows lost: 8 to 9, 13",
    )
    assert list(recovered.recording.columns["a_tacho_deg"]) == [*range(7), 9, 10, 11, *range(13, 20)]


def test_of_many_damages_the_first_are_told_and_how_many_more_there_are(tmp_path):
    data = bytearray(begun(tmp_path / "run.parquet", 20))
    head, size = data.index(b"NXTr", data.index(b"NXTr", 1) + 1), 20 + 8 * len(COLUMNS)
    places = [head + row * size for row in (2, 5, 8, 11, 19)]
    for place in places:
        data[place + 25] ^= 4
    (tmp_path / "damaged.csv.stream").write_bytes(data)
    first = ", ".join(f"byte {place}" for place in places[:3])
    recovered = recover(tmp_path / "damaged.csv")
    assert recovered.damages == (f"damaged at {first} and 2 places more", "rows lost: 3, 6, 9, …")
    with pytest.raises(FrozenInstanceError):
        recovered.damages = ()


def test_a_last_row_that_is_damaged_takes_all_after_it(tmp_path):
    data = bytearray(begun(tmp_path / "run.parquet", 20))
    data[-5] ^= 4
    (tmp_path / "damaged.csv.stream").write_bytes(data)
    assert recover(tmp_path / "damaged.csv").damages[1] == "rows lost: all after 19"


def test_a_mode_that_nobody_knows_is_no_recording(tmp_path):
    writer = RecordingWriter(tmp_path / "run.csv", ("time_s", "a_mode"))
    for mode in (0.0, 7.0):
        writer.row({"time_s": mode, "a_mode": mode})
    with pytest.raises(RecordingError, match="column a_mode: holds what is no known mode"):
        writer.finish()


def test_the_sidecar_is_renewed_each_time_that_there_are_twice_as_many_rows(tmp_path):
    writer, at = RecordingWriter(tmp_path / "run.csv", COLUMNS), []
    writer.keep_lags(SimpleNamespace(write_beside=lambda _: at.append(writer.rows)))
    for row in rows(10):
        writer.row(row)
    writer.finish()
    assert at == [0, 1, 2, 4, 8, 10]


def test_a_disk_that_is_full_leaves_the_rows_before(tmp_path, monkeypatch):
    path = tmp_path / "run.csv"
    writer = RecordingWriter(path, COLUMNS)
    for row in rows(5):
        writer.row(row)
    monkeypatch.setattr(writer, "_file", Full(writer._file))
    with pytest.raises(RecordingError, match="nxt-twin recover"):
        writer.row({"time_s": 9.0})
    writer.finish()
    assert read_recording(path).rows == 5


def test_a_disk_that_refuses_says_why(tmp_path, monkeypatch):
    writer = RecordingWriter(tmp_path / "run.csv", COLUMNS)
    file = writer._file
    monkeypatch.setattr(writer, "_file", SimpleNamespace(write=_refuse))
    with pytest.raises(RecordingError, match="cannot be written: No space left on device"):
        writer.row({"time_s": 9.0})
    file.close()


def _refuse(*_):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_where_not_even_the_names_can_be_written_nothing_is_left(tmp_path, monkeypatch):
    with pytest.raises(RecordingError, match="check the folder"):
        RecordingWriter(tmp_path / "none" / "run.csv", COLUMNS)

    def full(*_):
        raise RecordingError("cannot be written: full")

    monkeypatch.setattr(RecordingWriter, "_write", full)
    with pytest.raises(RecordingError, match="full"):
        RecordingWriter(tmp_path / "run.csv", COLUMNS)
    assert not list(tmp_path.iterdir())


def test_without_locks_and_without_waiting_for_the_disk_it_is_recorded_all_the_same(tmp_path, monkeypatch):
    monkeypatch.setattr("fcntl.flock", _refuse)
    waits = iter([_refuse])  # the stream's; the recording's may wait
    monkeypatch.setattr(os, "fsync", lambda file: next(waits, bool)(file))
    copy = tmp_path / "copy.csv.stream"
    with RecordingWriter(tmp_path / "run.csv", COLUMNS) as writer:
        for row in rows(3):
            writer.row(row)
        copy.write_bytes(stream_path(writer.path).read_bytes())
    assert writer.finish() == tmp_path / "run.csv"
    assert recover(copy).recording.rows == 3


class Full:
    """A file that takes the first half of what is written."""

    def __init__(self, file):
        self._file = file

    def write(self, data):
        return self._file.write(data[: len(data) // 2])

    def __getattr__(self, name):
        return getattr(self._file, name)

    def __enter__(self):
        return self._file.__enter__()

    def __exit__(self, *failure):
        return self._file.__exit__(*failure)


def test_a_recording_that_came_meanwhile_is_not_written_over(tmp_path):
    path = tmp_path / "run.csv"
    writer = RecordingWriter(path, COLUMNS)
    for row in rows(5):
        writer.row(row)
    path.write_text("mine")
    with pytest.raises(RecordingError, match="there already"):
        writer.finish()
    with pytest.raises(RecordingError, match="there already"):
        recover(path)
    path.rename(tmp_path / "mine.csv")
    assert recover(path).recording.rows == 5


def test_nothing_to_recover_is_said(tmp_path):
    path = tmp_path / "run.parquet"
    with pytest.raises(RecordingError, match="nothing to recover"):
        recover(path)
    for content, why in [
        (b"", "nothing in it is whole"),
        (b"NXTr", "nothing in it is whole"),
        (b"\xff\xff\xff\xff\x10", "its beginning is damaged, or another version wrote it"),
        (begun(tmp_path / "other.parquet", 0), "cut off before its first row"),
    ]:
        stream_path(path).write_bytes(content)
        with pytest.raises(RecordingError, match=why):
            recover(path)
        assert stream_path(path).exists()


def test_a_stream_of_another_suffix_is_not_recovered(tmp_path):
    (tmp_path / "run.txt.stream").write_bytes(b"x")
    with pytest.raises(RecordingError, match="change the suffix"):
        recover(tmp_path / "run.txt")


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
