"""A payload that came on beside a recording which no fit saw: that recording has to tell when."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from diagnose_motors import settled

from nxt_twin.blind.bench import draw_commands, draw_motor
from nxt_twin.blind.case import NOMINAL
from nxt_twin.blind.record import take
from nxt_twin.blind.truth.sensing import Sensing
from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.judging import onset
from nxt_twin.diagnose.judging.onset import placed
from nxt_twin.diagnose.telling.notes import onsets_told
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.case import Case

SECONDS = 6.0
HELD_OUT = 2  # of four recordings
ONSET = Slot("payload_inertia", "onset")


def with_payload_from(first):
    """Four recordings, of which those from number `first` on carry a payload."""
    rng = np.random.default_rng(61)
    light = draw_motor(rng)
    heavy = replace(light, added_inertia_kg_m2=8e-4, added_from_s=0.0)
    runs = [
        draw_commands(rng, family, "usb", SECONDS, 0.5, 0.0)
        for family in ("steps", "ramps", "steps", "reversals")
    ]
    taken = [
        take(rng, f"r{n}.csv", heavy if n >= first else light, Sensing(), run).recording
        for n, run in enumerate(runs)
    ]
    return Case("made", Path(), {"kind": "dc_motor", **NOMINAL}, tuple(taken), (), "a")


@pytest.mark.slow_variants
@pytest.mark.parametrize(("first", "started_at"), [(HELD_OUT, HELD_OUT + 1), (HELD_OUT + 1, HELD_OUT)])
def test_the_held_out_recording_tells_whether_the_payload_was_on(first, started_at):
    case = with_payload_from(first)
    with Simulator(problem_for(case).plant.layout) as simulator:
        held_out = problem_for(case).held_out[0].signals
        ends = {HELD_OUT: held_out.session_s, HELD_OUT + 1: held_out.session_s + held_out.time_s[-1]}
        started = {"payload_inertia": {"added_inertia": 8e-4, "onset": ends[started_at]}}
        problem, _, final = settled(simulator, case, added=started)
        moved, told = placed(simulator, problem, final)
    assert [effect.id for effect in told] == ["payload_inertia"]
    assert moved.plant.values[ONSET] == pytest.approx(ends[first], abs=0.1 * SECONDS)
    assert "held-out" in onsets_told(told)[0]


def test_an_onset_that_fits_what_was_held_out_stays():
    case = with_payload_from(HELD_OUT)
    with Simulator(problem_for(case).plant.layout) as simulator:
        began_s = problem_for(case).held_out[0].signals.session_s
        started = {"payload_inertia": {"added_inertia": 8e-4, "onset": began_s}}
        problem, _, final = settled(simulator, case, added=started)
        moved, told = placed(simulator, problem, final)
    assert moved is final
    assert told == ()


def test_an_onset_may_be_the_beginning_of_what_was_held_out_though_later_readings_count():
    signals = SimpleNamespace(time_s=np.array([3.0, 4.0, 5.0, 6.0]), session_s=20.0)
    part = SimpleNamespace(signals=signals, counted=np.array([False, True, True, True]))
    tried = list(onset._moments(SimpleNamespace(held_out=[part])))
    assert tried[:2] == [20.0, 21.0]
    assert tried[-1] == 23.0


def costing(nats):
    """A target on which every plant but the first costs `nats` more."""
    target = SimpleNamespace(costs_of=lambda _, plants: np.where(np.arange(len(plants)) > 0, nats, 0.0))
    return SimpleNamespace(tuned=lambda *_: SimpleNamespace(everything=lambda: target))


def test_an_open_moment_may_be_less_likely_by_as_much_as_an_effect_has_to_gain(monkeypatch):
    case = with_payload_from(HELD_OUT)
    with Simulator(problem_for(case).plant.layout) as simulator:
        held_out = problem_for(case).held_out[0].signals
        later_s = held_out.session_s + held_out.time_s[-1]
        started = {"payload_inertia": {"added_inertia": 8e-4, "onset": later_s}}
        problem, _, final = settled(simulator, case, added=started)
        told = []
        for nats in (7.9, 8.1):
            monkeypatch.setattr(onset, "Fitter", lambda *_, nats=nats: costing(nats))
            told.append(len(placed(simulator, problem, final)[1]))
    assert told == [1, 0]
