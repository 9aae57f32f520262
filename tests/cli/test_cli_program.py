"""What all commands share: exit statuses, where things are said, and help."""

import subprocess
import sys

import pytest
from cli_program import run, succeed

from nxt_twin import __version__
from nxt_twin.cli.app import COMMANDS, main

BROKEN = {
    "no header": "0.0,0,0\n0.1,0,0\n",
    "a word for a number": "time_s,a_power_pct,a_tacho_deg\n0.0,0,0\n0.1,fast,0\n",
    "time going back": "time_s,a_power_pct,a_tacho_deg\n0.0,0,0\n0.2,0,0\n0.1,0,0\n",
    "nothing in it": "",
    "a column nobody knows": "time_s,a_power,a_tacho_deg\n0.0,0,0\n0.1,0,0\n",
}


def as_a_process(*arguments, cwd):
    program = [sys.executable, "-c", "from nxt_twin.cli import main; main()", *map(str, arguments)]
    return subprocess.run(program, capture_output=True, text=True, cwd=cwd, timeout=120, check=False)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_says_what_it_does(command):
    said = succeed(command, "--help").out
    assert "Usage: " in said
    assert command in said


def test_the_program_lists_its_commands():
    said = succeed("--help").out
    assert all(command in said for command in COMMANDS)


def test_the_version_is_told():
    assert succeed("--version").out == f"nxt-twin {__version__}\n"


@pytest.mark.parametrize(
    "arguments",
    [
        ("levitate",),
        ("--", "levitate"),
        ("--colour", "diagnose"),
        ("diagnose",),
        ("diagnose", "case", "--colour"),
        ("diagnose", "case", "--seed", "many"),
        ("simulate", "nxt_motor"),
        ("prepare", "no-such-set", "--out", "somewhere"),
        ("blind", "guess"),
    ],
)
def test_wrong_use_ends_with_2_and_says_so_on_standard_error(arguments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    outcome = run(*arguments)
    assert outcome.status == 2
    assert outcome.out == ""
    assert outcome.err
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_data_set_is_refused_with_those_there_are(tmp_path):
    outcome = run("prepare", "no-such-set", "--out", tmp_path)
    assert outcome.status == 2
    for name in ("emps", "ev3-large", "nxt-step"):
        assert name in outcome.err


def test_a_data_set_that_is_not_on_this_machine_is_missing_and_not_wrong_use(tmp_path):
    outcome = run("prepare", "emps", "--out", tmp_path / "cases", "--data", tmp_path)
    assert outcome.status == 1
    assert "docs/real-data.md" in outcome.err
    assert outcome.err.count("\n") == 1


@pytest.mark.parametrize("content", BROKEN.values(), ids=BROKEN)
@pytest.mark.parametrize("command", [("diagnose",), ("simulate", "nxt_motor"), ("fit",)], ids=lambda c: c[0])
def test_a_broken_recording_is_refused_in_one_line(command, content, tmp_path):
    recording = tmp_path / "broken.csv"
    recording.write_text(content)
    outcome = run(*command, recording)
    assert outcome.status == 1
    assert outcome.out == ""
    assert outcome.err.startswith(f"nxt-twin: {recording}")
    assert outcome.err.count("\n") == 1


def test_as_a_process_a_failure_is_status_1_and_one_line_and_wrong_use_is_status_2(tmp_path):
    (tmp_path / "broken.csv").write_text(BROKEN["a word for a number"])
    failed = as_a_process("simulate", "nxt_motor", "broken.csv", cwd=tmp_path)
    assert (failed.returncode, failed.stdout) == (1, "")
    assert failed.stderr.startswith("nxt-twin: broken.csv, row 3")
    assert failed.stderr.count("\n") == 1
    misused = as_a_process("simulate", "nxt_motor", cwd=tmp_path)
    assert (misused.returncode, misused.stdout) == (2, "")


def test_as_a_process_without_a_word_it_says_how_it_is_used(tmp_path):
    done = as_a_process(cwd=tmp_path)
    assert "Usage: " in done.stdout + done.stderr
    assert "Traceback" not in done.stderr


def test_a_shell_is_told_how_a_line_can_go_on(monkeypatch):
    line = {"_NXT_TWIN_COMPLETE": "complete_bash", "COMP_WORDS": "nxt-twin dia", "COMP_CWORD": "1"}
    for name, value in line.items():
        monkeypatch.setenv(name, value)
    named = "import sys; sys.argv = ['nxt-twin']; from nxt_twin.cli import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", named], capture_output=True, text=True, timeout=120, check=False
    )
    assert done.stdout.split() == ["diagnose"]


def test_as_a_process_json_without_a_value_is_the_whole_of_standard_output(cases, tmp_path):
    said = as_a_process(
        "simulate", "nxt_motor", cases["clean"] / "r1.csv", "--json", "--out", "p.csv", cwd=tmp_path
    )
    assert said.returncode == 0
    assert said.stdout.startswith('{"schema": "nxt-twin/simulation/1"')
    assert said.stdout.count("\n") == 1
    assert said.stderr == ""
    assert (tmp_path / "p.csv").exists()


@pytest.mark.parametrize("interrupted", [KeyboardInterrupt(), SystemExit(130)])
def test_an_interrupt_ends_with_one_line_and_status_1(interrupted, monkeypatch, capsys):
    def interrupt(_):
        def run(_):
            raise interrupted

        return run

    monkeypatch.setattr("nxt_twin.cli.app.program", interrupt)
    monkeypatch.setattr("sys.argv", ["nxt-twin", "udev"])
    with pytest.raises(SystemExit) as left:
        main()
    assert left.value.code == 1
    assert capsys.readouterr().err == "nxt-twin: interrupted\n"
