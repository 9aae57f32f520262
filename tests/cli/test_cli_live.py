"""`nxt-twin live` on a mock brick inside the program; sessions pass in virtual time, at any load of the machine."""

from typing import get_args

import pytest
import yaml
from cli_program import run, succeed

from nxt_twin.cli import holding
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.serve.profile import PROFILES, LinkProfile
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.files import read_recording


@pytest.fixture
def at_once(monkeypatch):
    """Lets a session's seconds pass as soon as it waits for them."""
    monkeypatch.setattr(holding, "SystemClock", VirtualClock)


@pytest.mark.usefixtures("at_once")
def test_a_session_tells_its_verdict_and_keeps_what_it_saw(tmp_path):
    out = tmp_path / "session.csv"
    plant = tmp_path / "then-a.yaml"
    plant.write_text(yaml.safe_dump(load_plant_config("nxt_motor")))
    since = ("--since", tmp_path / "then.yaml")
    arguments = ("live", "mock:", "--ports", "a", "--seconds", "2", *since, "--out", out, "--json", "-")
    document = succeed(*arguments).json()
    assert document["schema"] == "nxt-twin/live/1"
    assert document["verdict"] == "holds"
    assert document["motors"] == {"a": {"diverging": False, "trouble": None}}
    assert "too little to compare" in document["since"]["a"]["refused"]
    assert [event["kind"] for event in document["events"]] == ["started", "stopped"]
    recording = read_recording(out)
    assert recording.rows == document["polls"]
    assert {"a_power_pct", "a_mode", "a_tacho_deg", "battery_v"} <= recording.columns.keys()


@pytest.mark.usefixtures("at_once")
def test_a_divergence_is_said_in_a_line_and_is_no_failure(tmp_path):
    world = tmp_path / "world.yaml"
    motor = (
        "{kind: dc_motor, resistance_ohm: 7.6, torque_constant_nm_per_a: 0.49, back_emf_v_s_per_rad: 0.49, "
        "coulomb_friction_nm: 0.05, inertia_kg_m2: 1.2e-3}"
    )
    world.write_text(f"motors:\n  a: {motor}\n")
    model = tmp_path / "model.yaml"
    outcome = succeed("live", f"mock:?world={world}", "--ports", "a", "--seconds", "4", "--model-out", model)
    lines = outcome.out.splitlines()
    assert any("the motor turns slower than its model predicts" in line for line in lines)
    assert lines[-1].startswith("brick and model diverge; port A")
    assert "dc_motor" in model.read_text()


@pytest.mark.usefixtures("at_once")
def test_a_motor_program_is_run_and_watching_alone_moves_nothing(tmp_path):
    program = tmp_path / "p.yaml"
    program.write_text(
        "kind: motor_program\nname: p\nports: [b]\nruns:\n- name: r\n  segments:\n"
        "  - {duration_s: 5.0, power_pct: 70}\n"
    )
    out = tmp_path / "b.csv"
    succeed("live", "mock:", "--ports", "b", "--program", program, "--seconds", "1.5", "--out", out)
    assert read_recording(out).columns["b_tacho_deg"][-1] > 200
    still = tmp_path / "still.csv"
    succeed("live", "mock:", "--ports", "b", "--program", "none", "--seconds", "0.7", "--out", still)
    assert set(read_recording(still).columns["b_tacho_deg"]) == {0.0}


def test_wrong_use_is_status_2():
    assert run("live", "mock:", "--ports", "x").status == 2
    assert run("live", "mock:", "--sensors", "5:touch").status == 2
    assert run("live", "mock:", "--since", "nxt_motor", "--plant", "nxt_motor").status == 2
    assert run("live", "nowhere:").status == 2
    outcome = run("live", "usb:", "--seconds", "1")
    assert outcome.status == 2
    assert "--yes" in outcome.err


def test_what_cannot_be_reached_is_status_1():
    outcome = run("live", "tcp:127.0.0.1:9", "--seconds", "1")
    assert outcome.status == 1
    assert outcome.err.startswith("nxt-twin: ")
    assert run("live", "mock:", "--program", "no-such-program").status == 1


def test_a_session_without_a_single_poll_has_failed_and_says_so(tmp_path):
    out = tmp_path / "none.csv"
    outcome = run("live", "mock:", "--ports", "a", "--seconds", "1e-6", "--out", out)
    assert outcome.status == 1
    assert "the brick answered no poll" in outcome.err
    assert not out.exists()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "arguments",
    [
        ("mock", "--profile", "smoke"),
        ("mock", "--tcp", "nowhere"),
        ("live", "mock:?profile=smoke"),
        ("record", "mock:?profile=smoke", "--out", "run.csv"),
        ("drive", "nudge", "mock:?profile=smoke"),
    ],
)
def test_a_link_that_cannot_be_is_wrong_use(arguments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    outcome = run(*arguments)
    assert outcome.status == 2, outcome
    assert "smoke" in outcome.err or "nowhere" in outcome.err
    assert list(tmp_path.iterdir()) == []


def test_every_profile_of_a_link_can_be_asked_for():
    assert set(get_args(LinkProfile)) == set(PROFILES)
