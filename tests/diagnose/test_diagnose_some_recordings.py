"""A payload that only some recordings carry, and that is gone afterwards."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from nxt_twin.blind.bench import draw_commands, draw_motor
from nxt_twin.blind.case import NOMINAL
from nxt_twin.blind.record import take
from nxt_twin.blind.truth.sensing import Sensing
from nxt_twin.diagnose.engine import diagnose, problem_for
from nxt_twin.diagnose.fitting.variables import starts_of
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.library import library
from nxt_twin.recording.case import Case

SECONDS = 8.0
ADDED_KG_M2 = 8e-4


def with_payload_in(carrying):
    """As many recordings as `carrying` has entries; those that are true carry a payload."""
    rng = np.random.default_rng(61)
    light = draw_motor(rng)
    heavy = replace(light, added_inertia_kg_m2=ADDED_KG_M2, added_from_s=0.0)
    taken = []
    for number, loaded in enumerate(carrying):
        run = draw_commands(rng, ("steps", "ramps")[number % 2], "usb", SECONDS, 0.5, 0.0)
        taken.append(take(rng, f"r{number}.csv", heavy if loaded else light, Sensing(), run).recording)
    return Case("made", Path(), {"kind": "dc_motor", **NOMINAL}, tuple(taken), (), "a")


@pytest.mark.parametrize(
    ("effect_id", "onset", "removed"),
    [("payload_inertia", "onset", "removed"), ("hanging_payload", "hung_at", "taken_off_at")],
)
def test_a_payload_is_sought_in_every_row_of_recordings_that_ends_before_the_last(effect_id, onset, removed):
    problem = problem_for(with_payload_in((False,) * 4))
    begins_s = [signals.session_s for signals in problem.signals]
    starts = starts_of(problem.plant.layout.effect(effect_id), problem.scale)
    rows = [(one[onset], one[removed]) for one in starts if one[removed] < 5.0 * SECONDS]
    assert rows == [(a, b) for n, a in enumerate(begins_s) for b in begins_s[n + 1 :]]


@pytest.mark.parametrize(("count", "rows"), [(8, 28), (9, 18), (60, 28)])
def test_of_many_recordings_a_few_rows_are_tried(count, rows):
    signals = [
        SimpleNamespace(session_s=5.0 * n, sets_in_s=np.nan, time_s=np.array([0.0, 5.0]))
        for n in range(count)
    ]
    assert len(library()["payload_inertia"].further_starts(signals)) == rows


@pytest.mark.parametrize("carrying", [(True, False), (False, True, False)])
def test_a_payload_that_goes_again_is_named(carrying):
    case = with_payload_in(carrying)
    answer = diagnose(case)
    assert answer.diagnosis.verdict == "explained"
    (found,) = answer.diagnosis.effects
    assert found.id == "payload_inertia"
    assert found.params["added_inertia_kg_m2"].value == pytest.approx(ADDED_KG_M2, rel=0.25)
    gone_s = answer.plant.values[Slot("payload_inertia", "removed")]
    assert gone_s == pytest.approx((1 + carrying.index(True)) * SECONDS, abs=1.0)


def test_a_payload_in_the_held_out_recording_alone_is_named_once_another_is_held_out():
    case = with_payload_in((False, False, True))
    said = []
    answer = diagnose(case, progress=said.append)
    assert answer.diagnosis.verdict == "explained"
    (found,) = answer.diagnosis.effects
    assert found.id == "payload_inertia"
    assert [run.recording for run in answer.diagnosis.held_out] == ["r1.csv"]
    assert any("others held out" in words for words in said)
    assert any("r2.csv" in note and "held out" in note for note in answer.diagnosis.notes)


def test_a_recording_that_a_user_holds_out_stays_held_out():
    case = with_payload_in((False, False, True))
    stated = replace(case, recordings=case.recordings[:2], holdout=case.recordings[2:])
    answer = diagnose(stated)
    assert answer.diagnosis.verdict == "unexplained"
    assert [run.recording for run in answer.diagnosis.held_out] == ["r2.csv"]


def test_the_second_choice_holds_out_the_recording_before_each_third_one():
    case = with_payload_in((False,) * 5)
    assert [part.signals.name for part in problem_for(case).held_out] == ["r2.csv"]
    turned = problem_for(case, second=True)
    assert [part.signals.name for part in turned.held_out] == ["r1.csv", "r4.csv"]
    assert [signals.name for signals in turned.signals] == ["r0.csv", "r2.csv", "r3.csv"]
