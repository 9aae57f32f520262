"""Sessions wired from options, and what they come to, in virtual time."""

import json

from twin_feed import nxt_motor
from twin_rig import Rig

from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.recording.files import read_recording
from nxt_twin.twin.driver import excitation
from nxt_twin.twin.live import LiveOptions, live_sitting
from nxt_twin.twin.replayed import replay_sitting
from nxt_twin.twin.sinks import Memory

PLANTS = {"a": nxt_motor()}


def held(out=None, *, seconds=4.0, **options):
    rig, seen = Rig(), Memory()
    wanted = LiveOptions(PLANTS, program=excitation(("a",)), out=out, **options)
    sitting = live_sitting(wanted, rig.open, rig.clock, seen)
    try:
        sitting.run(seconds)
    finally:
        sitting.close()
    return sitting.outcome(), seen


def test_an_outcome_holds_what_was_told_and_is_json():
    outcome, seen = held()
    assert outcome.verdict.outcome == "holds"
    assert outcome.polls == seen.count > 100
    assert [event.kind for event in outcome.events] == ["started", "stopped"]
    document = json.loads(json.dumps(outcome.document()))
    assert document["polls"] == outcome.polls
    assert document["motors"] == {"a": {"diverging": False, "trouble": None}}
    assert document["diagnoses"] == []


def test_a_recorded_session_is_replayed_as_it_was(tmp_path):
    live, _ = held(tmp_path / "run.csv", sensors={4: "ultrasonic"})
    recording = read_recording(tmp_path / "run.csv")
    assert recording.time_s.size == live.polls
    seen = Memory()
    sitting, duration_s = replay_sitting(recording, PLANTS, VirtualClock(), seen)
    sitting.run(duration_s)
    sitting.close()
    outcome = sitting.outcome()
    assert outcome.verdict.outcome == "holds"
    assert outcome.polls > 0.9 * live.polls
    assert {"a_tacho_deg", "s4_ultrasonic_cm"} <= {i.channel for tick in seen.ticks for i in tick.innovations}


def test_a_session_ends_as_soon_as_enough_was_seen():
    outcome, _ = held(enough=lambda: True)
    assert outcome.polls == 0
