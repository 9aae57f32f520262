"""A session with three motors, recorded and played again."""

from dataclasses import replace
from pathlib import Path

import pytest
import yaml
from twin_feed import nxt_motor
from twin_rig import EVERY_SENSOR, Rig, run

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import PacedClock
from nxt_twin.brick.links.recorded import RecordedBrick, RecordedCommands
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.errors import RecordingError
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.recording.case import Case
from nxt_twin.recording.files import read_recording, read_sidecar
from nxt_twin.recording.lags import KnownLags
from nxt_twin.recording.stream import RecordingWriter
from nxt_twin.twin.brick_twin import BrickTwin, TwinOptions
from nxt_twin.twin.bridge import plain_bridge
from nxt_twin.twin.driver import ProgramDriver, excitation
from nxt_twin.twin.logbook import Logbook, columns_to_fill
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.session import Parts, Session
from nxt_twin.twin.settings import AT_ARRIVAL, PACES
from nxt_twin.twin.sinks import Memory

PORTS = ("a", "b", "c")
SESSION_S = 10.0


def _watched(path, profile):
    """A session's recording."""
    outcome = run(Rig(profile=profile), SESSION_S, ports=PORTS, sensors=EVERY_SENSOR)
    with RecordingWriter(path, columns_to_fill(PORTS, EVERY_SENSOR)) as writer:
        for row in outcome.rows:
            writer.row(row)
    outcome.session.row_lags.write_beside(path)
    assert "divergence" not in outcome.kinds()


def _written_down(path, profile, seconds=SESSION_S):
    """One that nobody watched."""
    rig, driver = Rig(profile=profile), ProgramDriver(excitation(PORTS))
    pace = PACES["bt" if profile == "bluetooth" else "usb"]
    with rig.open() as brick, RecordingWriter(path, columns_to_fill(PORTS, EVERY_SENSOR)) as writer:
        logbook = Logbook(brick, rig.clock, PORTS, Plan(EVERY_SENSOR), writer, driver, pace)
        logbook.keep(seconds)
    logbook.row_lags.write_beside(path)


def _divergences(path, lags):
    clock = PacedClock(VirtualClock(), 1.0)
    brick, memory = RecordedBrick(read_recording(path), clock), Memory(10**6)
    options = TwinOptions(candidates=(), bridge=plain_bridge)
    parts = Parts(
        open_brick=lambda: Brick(brick, clock),
        clock=clock,
        twin=BrickTwin(dict.fromkeys(PORTS, nxt_motor()), options),
        sink=memory,
        pace=AT_ARRIVAL,
        driver=RecordedCommands(brick, PORTS),
        lags=lags,
    )
    Session(parts).run(brick.duration_s)
    return [event.words for event in memory.events if event.kind == "divergence"]


@pytest.mark.slow_variants
@pytest.mark.parametrize("profile", ["usb", "bluetooth"])
@pytest.mark.parametrize("record", [_watched, _written_down])
def test_three_motors_played_again_hold_as_they_did_live(tmp_path, record, profile):
    path = tmp_path / "run.csv"
    record(path, profile)
    assert _divergences(path, read_recording(path).lags) == []
    assert _divergences(path, KnownLags()) != []


@pytest.mark.slow
def test_lags_are_no_delay_to_a_diagnosis(tmp_path):
    path = tmp_path / "run.csv"
    _written_down(path, "bluetooth", 25.0)
    told = read_recording(path)
    assert _named(told) == []
    assert _named(replace(told, lags=KnownLags())) == ["command_delay"]


def _named(recording):
    case = Case("run", Path(), nxt_motor().to_config(), (recording,), (), "a")
    return [effect.id for effect in diagnose(case).diagnosis.effects]


def test_lags_of_an_earlier_recording_of_that_name_are_replaced(tmp_path):
    path, lags = tmp_path / "run.csv", run(Rig(), 1.0).session.row_lags
    (tmp_path / "run.yaml").write_text("row_lags: {read_before_s: {a: 7.0}}\n")
    lags.write_beside(path)
    assert 0.0 < KnownLags(read_sidecar(path)).read_before_s("a")[0] < 0.01


def test_a_users_sidecar_is_left_alone(tmp_path):
    session = run(Rig(), 1.0).session
    (tmp_path / "run.yaml").write_text("plant: nxt_motor\n")
    session.row_lags.write_beside(tmp_path / "run.csv")
    assert yaml.safe_load((tmp_path / "run.yaml").read_text()) == {"plant": "nxt_motor"}
    assert KnownLags({"row_lags": None}).read_before_s("a") == (0.0, 0.0)


@pytest.mark.parametrize(
    "told", ["3", "{read_before_s: [1]}", "{acted_after_s: {a: soon}}", "{read_std_s: {a: .nan}}"]
)
def test_nonsense_about_lags_is_told_with_its_place(tmp_path, told):
    (tmp_path / "run.csv").write_text("time_s,a_power_pct,a_tacho_deg\n0,0,0\n0.01,0,0\n")
    (tmp_path / "run.yaml").write_text(f"row_lags: {told}\n")
    with pytest.raises(RecordingError, match=r"run\.yaml, key row_lags"):
        read_recording(tmp_path / "run.csv")
