"""Record, drive, replay, recover, and a mock brick that conceals something."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time

import pytest
from cli_program import column, run, succeed

from nxt_twin.cli.record import remark_on_stalls
from nxt_twin.recording.files import read_recording
from nxt_twin.recording.programs import load_program, own_programs
from nxt_twin.recording.stream import stream_path
from nxt_twin.twin.driver import ProgramDriver, excitation

PROGRAM = (sys.executable, "-c", "from nxt_twin.cli import main; main()")

SHORT = """
kind: motor_program
name: Short
most_turn_deg: 500
rest_s: 0.1
runs:
  - name: one
    segments: [{duration_s: 0.2}, {duration_s: 0.5, power_pct: 60}]
  - name: two
    segments: [{duration_s: 0.2, power_pct: -60}]
"""


@pytest.fixture
def short(tmp_path):
    file = tmp_path / "short.yaml"
    file.write_text(SHORT)
    return file


@pytest.fixture(scope="module")
def driven(tmp_path_factory):
    """A recording of a motor with a voltage drop concealed in it."""
    path = tmp_path_factory.mktemp("driven") / "run.parquet"
    succeed(
        "record",
        "mock:?conceal=1",
        "--ports",
        "a",
        "--program",
        "gentle_steps",
        "--seconds",
        6,
        "--out",
        path,
    )
    return path


def test_a_mock_is_recorded_with_its_sensors(tmp_path):
    path = tmp_path / "r.csv"
    told = succeed(
        "record", "mock:", "--seconds", 0.6, "--sensors", "1:touch,4:ultrasonic", "--out", path, "--json"
    ).json()
    recording = read_recording(path)
    assert told["schema"] == "nxt-twin/record/1"
    assert (told["file"], told["rows"]) == (str(path), recording.rows)
    assert {"a_tacho_deg", "b_tacho_deg", "c_tacho_deg", "s1_touch"} <= set(recording.columns)
    first, second, third = (recording.lags.read_before_s(port)[0] for port in ("a", "b", "c"))
    assert first > second > third > 0.0
    assert not stream_path(path).exists()


@pytest.mark.parametrize(
    ("wait_s", "told"), [(0.0, ""), (0.6, "stood still once, for up to 600 ms (at 1.0 s)")]
)
def test_a_recording_during_which_the_host_stood_still_is_told(tmp_path, capsys, wait_s, told):
    rows = "".join(f"{0.01 * row + wait_s * (row > 100):.2f},0,0\n" for row in range(200))
    (tmp_path / "run.csv").write_text("time_s,a_power_pct,a_tacho_deg\n" + rows)
    remark_on_stalls(tmp_path / "run.csv")
    said = capsys.readouterr().err
    assert told in said
    assert bool(said) == bool(told)


def test_a_recorded_program_is_in_the_recording(driven):
    assert set(column(driven, "a_power_pct")) >= {25.0, -25.0, 40.0}
    assert column(driven, "a_tacho_deg").max() > 30


def test_each_run_of_a_program_becomes_a_recording(short, tmp_path):
    out = tmp_path / "r.parquet"
    told = succeed("drive", short, "mock:", "--record", out, "--json").json()
    assert [each["file"] for each in told["runs"]] == [
        str(tmp_path / "r-one.parquet"),
        str(tmp_path / "r-two.parquet"),
    ]
    assert column(tmp_path / "r-one.parquet", "a_tacho_deg")[-1] > 30
    assert column(tmp_path / "r-two.parquet", "a_power_pct").min() == -60


def test_no_motor_turns_where_a_recording_is_in_the_way(short, tmp_path):
    (tmp_path / "r-two.csv").write_text("mine")
    outcome = run("drive", short, "mock:", "--record", tmp_path / "r.csv")
    assert (outcome.status, outcome.err.count("there already")) == (1, 1)
    assert not (tmp_path / "r-one.csv").exists()


def test_a_program_runs_without_being_recorded(short, tmp_path):
    outcome = succeed("drive", short, "mock:", "--ports", "bc")
    assert [line.split(":")[0] for line in outcome.out.splitlines()] == ["one", "two"]
    assert [each.name for each in tmp_path.iterdir()] == ["short.yaml"]


def test_the_programs_are_listed_with_what_they_are_for():
    listed = succeed("drive", "--json").json()["programs"]
    assert {each["name"] for each in listed} == set(own_programs())
    assert all(each["why"] and each["seconds"] < 60 for each in listed)


def test_the_program_of_live_is_there_as_a_file():
    assert load_program("excitation") == excitation(("a",))


@pytest.mark.parametrize("name", sorted(own_programs()))
def test_every_program_of_the_tool_is_gentle_enough(name):
    program = load_program(name)
    assert program.why
    assert ProgramDriver(program).duration_s < 60
    for each in program.runs:
        assert each.segments[0].power_pct == 0
        assert all(segment.duration_s <= 3.0 for segment in each.segments)


def test_a_replay_names_what_was_concealed(driven):
    told = succeed("replay", driven, "--speed", 0, "--json").json()
    assert told["verdict"] == "diverges"
    assert told["polls"] == read_recording(driven).rows
    kinds = [event["kind"] for event in told["events"]]
    assert kinds[0] == "started"
    assert "divergence" in kinds
    onset = next(event for event in told["events"] if event["kind"] == "divergence")
    assert onset["port"] == "a"


def test_a_replay_is_the_same_each_time_and_at_any_speed(driven):
    once, again = (succeed("replay", driven, "--speed", speed, "--json").json() for speed in (0, 0))
    assert once == again
    assert succeed("replay", driven, "--speed", 8, "--json").json() == once


def test_what_is_concealed_is_told_when_asked(tmp_path):
    told = succeed("blind", "reveal", 1, "--json").json()
    assert [effect["id"] for effect in told["effects"]] == ["voltage_drop"]
    assert "voltage_drop" in succeed("blind", "reveal", 1).out
    nothing = tmp_path / "nothing.yaml"
    nothing.write_text("effects: []\n")
    assert "nothing" in succeed("blind", "reveal", nothing).out


@pytest.mark.parametrize(
    "arguments",
    [
        ("record", "mock:"),
        ("record", "mock:", "--out", "r.csv", "--ports", "d"),
        ("record", "mock:", "--out", "r.csv", "--sensors", "5:touch"),
        ("record", "no-url", "--out", "r.csv", "--seconds", "1"),
        ("drive", "gentle_steps", "tcp:192.0.2.1:1"),
        ("replay",),
    ],
)
def test_wrong_use_has_status_2(arguments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(*arguments).status == 2
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "arguments",
    [
        ("record", "tcp:127.0.0.1:1", "--out", "r.csv"),
        ("record", "mock:?conceal=no-such.yaml", "--out", "r.csv"),
        ("drive", "no_such", "mock:"),
        ("drive", "gentle_steps", "tcp:127.0.0.1:1", "--yes"),
        ("recover", "r.csv"),
        ("replay", "r.csv"),
        ("blind", "reveal", "no-such.yaml"),
        ("mock", "--conceal", "no-such.yaml"),
    ],
)
def test_what_cannot_be_done_has_status_1_and_one_line(arguments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    outcome = run(*arguments)
    assert outcome.status == 1
    assert len(outcome.err.strip().splitlines()) == 1
    assert not list(tmp_path.iterdir())


def test_a_recording_that_is_killed_is_recovered(tmp_path):
    path = tmp_path / "r.parquet"
    command = [*PROGRAM, "record", "mock:", "--out", str(path), "--ports", "a"]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        while not (stream_path(path).exists() and stream_path(path).stat().st_size > 20_000):
            assert process.poll() is None
            time.sleep(0.05)
        os.kill(process.pid, signal.SIGKILL)
    assert "is being written" in run("record", "mock:", "--out", path, "--seconds", 1).err
    told = json.loads(succeed("recover", path, "--json").out)
    assert told["rows"] == read_recording(path).rows > 50
    assert not stream_path(path).exists()


def test_an_interrupt_is_an_ordinary_end_of_a_recording(tmp_path):
    path = tmp_path / "r.parquet"
    command = [*PROGRAM, "record", "mock:", "--out", str(path), "--ports", "a"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        while not (stream_path(path).exists() and stream_path(path).stat().st_size > 10_000):
            assert process.poll() is None
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate()
    assert (process.returncode, err) == (0, "")
    assert str(path) in out
    assert read_recording(path).rows > 20


def test_a_program_that_is_told_to_end_lets_the_motors_go(tmp_path):
    path = tmp_path / "r.csv"
    command = [*PROGRAM, "drive", "speeds", "mock:", "--record", str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        part = stream_path(tmp_path / "r-up.csv")
        while not (part.exists() and part.stat().st_size > 10_000):
            assert process.poll() is None
            time.sleep(0.05)
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate()
    assert (process.returncode, err) == (1, "nxt-twin: interrupted\n")
    assert read_recording(tmp_path / "r-up.csv").rows > 20
