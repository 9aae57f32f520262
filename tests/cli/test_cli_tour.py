"""The tour, without its commands run: what it shows, where it writes, and how it ends."""

import subprocess

import pytest
from cli_program import run, succeed

from nxt_twin.cli import tour
from nxt_twin.cli.app import COMMANDS


@pytest.fixture
def visited(monkeypatch):
    """The commands that the tour ran, and the folder in which it ran each."""
    ran = []

    def note(command, *, cwd, **_):
        ran.append((command[3:], cwd))
        return subprocess.CompletedProcess(command, 0)

    monkeypatch.setattr(tour.subprocess, "run", note)
    return ran


def test_the_tour_shows_and_runs_each_command_in_a_folder_that_is_gone_afterwards(
    visited, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    said = succeed("tour", "--yes").out
    assert [command[0] for command, _ in visited] == ["connect", "record", "diagnose", "blind", "simulate"]
    assert all(f"$ nxt-twin {command[0]}" in said for command, _ in visited)
    assert not any(folder.exists() for _, folder in visited)
    assert list(tmp_path.iterdir()) == []


def test_every_command_of_the_tour_is_one_of_the_program():
    assert {stop.command[0] for stop in tour.STOPS} <= set(COMMANDS)


@pytest.mark.usefixtures("visited")
def test_a_folder_that_is_asked_for_stays_and_is_not_written_over(tmp_path):
    assert str(tmp_path / "mine") in succeed("tour", "--yes", "--out", tmp_path / "mine").out
    assert (tmp_path / "mine" / "secret.yaml").exists()
    (tmp_path / "mine" / "run.csv").write_text("")
    again = run("tour", "--yes", "--out", tmp_path / "mine")
    assert again.status == 1
    assert "holds a tour already" in again.err


def test_a_step_that_fails_ends_the_tour_with_one_line(monkeypatch, tmp_path):
    monkeypatch.setattr(tour.subprocess, "run", lambda command, **_: subprocess.CompletedProcess(command, 1))
    outcome = run("tour", "--yes", "--out", tmp_path)
    assert outcome.status == 1
    assert outcome.err.startswith("nxt-twin: tour, step 1")
    assert outcome.err.count("\n") == 1
