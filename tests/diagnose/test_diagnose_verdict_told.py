"""What is left and does not matter is no objection, and what the sentence tells of the rest."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from diagnose_records import FOUND, QUIET

from nxt_twin.diagnose.diagnosis import Estimate, FoundEffect, Ratio
from nxt_twin.diagnose.engine import _stood_still, _what_is_left
from nxt_twin.diagnose.judging.run_outs import RunOut
from nxt_twin.diagnose.judging.verdict import leaves_little, verdict_of
from nxt_twin.diagnose.next import next_step
from nxt_twin.diagnose.next.next_step import next_experiment
from nxt_twin.diagnose.telling import words
from nxt_twin.physics.modes import MODE_COAST

STRUCTURED = replace(QUIET, left_nats=100.0, torque_after=1.0)


def test_what_is_left_and_does_not_matter_is_no_objection():
    left = replace(STRUCTURED, surprise=100.0)
    assert verdict_of(left) == "unexplained"
    assert verdict_of(replace(left, matters=False)) == "adequate"
    found = replace(FOUND, left_nats=1e4, torque_after=1.0, torque_before=1.0, run_ratio=1.0)
    assert verdict_of(found) == "unexplained"
    assert verdict_of(replace(found, matters=False, remaining=1.0)) == "explained"


@pytest.mark.parametrize(
    ("changes", "little"),
    [
        ({}, True),
        ({"remaining": 1.01}, False),
        ({"matters": True}, False),
        ({"left_nats": 1.0, "torque_after": 1e-2}, False),
    ],
)
def test_what_is_left_and_smaller_than_the_tolerance_is_told_in_the_sentence(changes, little):
    record = replace(replace(STRUCTURED, matters=False, remaining=1.0), **changes)
    assert leaves_little(record) is little
    evidence = SimpleNamespace(
        record=record,
        units=SimpleNamespace(reading_factor=57.3, reading="deg"),
        problem=SimpleNamespace(tolerance=0.5 / 57.3),
    )
    told = ("More than noise is left, but less than the tolerance of 0.5 deg.",)
    assert _what_is_left(evidence, "adequate") == (told if little else ())
    assert _what_is_left(evidence, "unexplained") == ()


def test_with_nothing_found_and_nothing_left_nothing_is_missing():
    assert verdict_of(QUIET) == "adequate"


def test_what_was_found_and_leaves_noise_explains():
    assert verdict_of(FOUND) == "explained"


def test_stalls_speak_against_several_effects_and_not_against_one_that_leaves_nothing_that_matters():
    stalled = replace(FOUND, stalled_share=1.0, matters=False)
    assert verdict_of(replace(stalled, named=1)) == "explained"
    assert verdict_of(replace(stalled, named=2, least_nats=199.0)) == "unexplained"
    assert verdict_of(replace(stalled, named=2, least_nats=201.0)) == "explained"
    assert verdict_of(replace(stalled, named=1, matters=True)) == "unexplained"


def test_stalls_that_leave_names_in_doubt_are_in_the_sentence_and_ask_for_a_quiet_host():
    stalled = SimpleNamespace(record=replace(FOUND, named=2, stalled_share=0.2), problem=None)
    assert _stood_still(stalled, "unexplained") == (
        "The host or the link stood still for 20 % of a recording, so no name is sure.",
    )
    told = next_experiment(None, stalled, "unexplained", None, None, None)
    assert told == words.experiment_for_stalled()
    steady = SimpleNamespace(record=replace(FOUND, named=2, stalled_share=0.02), problem=None)
    assert _stood_still(steady, "unexplained") == ()
    assert _stood_still(stalled, "explained") == ()


@pytest.mark.parametrize(
    ("in_vain", "ran_out", "asked"),
    [(True, True, "coast-downs"), (True, False, "what"), (False, True, "what")],
)
def test_effects_that_fail_on_coast_downs_alone_ask_for_coast_downs(monkeypatch, in_vain, ran_out, asked):
    found = SimpleNamespace(record=replace(FOUND, leaves_most=in_vain), problem=None)
    run_outs = [RunOut("r3.csv", {MODE_COAST: 2.0})] if ran_out else []
    monkeypatch.setattr(next_step, "near_rivals", lambda _: [])
    monkeypatch.setattr(next_step, "unfitted_run_outs", lambda *_: run_outs)
    monkeypatch.setattr(next_step, "_twice_and_half", lambda _: {})
    monkeypatch.setattr(next_step, "_run_outs", lambda _: {})
    monkeypatch.setattr(next_step, "_with_program", lambda _problem, _hint, name, _runs: name)
    assert next_experiment(None, found, "unexplained", None, None, None).startswith(asked)


def test_numbers_that_moved_far_are_no_objection_where_nothing_was_found():
    assert verdict_of(replace(QUIET, moved=100.0)) == "adequate"
    assert verdict_of(replace(FOUND, moved=100.0)) == "unexplained"


def test_numbers_that_were_fitted_without_the_found_effects_may_move_far():
    assert verdict_of(replace(FOUND, moved=100.0, given_is_a_fit=True)) == "explained"


@pytest.mark.parametrize(
    ("nearer", "run_ratio", "verdict"),
    [(0.15, 0.15, "explained"), (0.151, 0.15, "unexplained"), (0.15, 0.151, "unexplained")],
)
def test_numbers_may_move_far_where_nearly_no_error_is_left(nearer, run_ratio, verdict):
    assert verdict_of(replace(FOUND, moved=100.0, nearer=nearer, run_ratio=run_ratio)) == verdict


def told_size(value, std, ratio=None):
    size = Estimate(value, std, "N·m", ratio=Ratio(*ratio, "1/s²", "inertia_kg_m2") if ratio else None)
    return FoundEffect("stiction", "stiction", "…", {"breakaway_torque_nm": size}, 0.9, ())


def test_a_size_whose_interval_is_wider_than_itself_is_told():
    open_one, sure = told_size(-0.1, 0.0256), told_size(0.1, 0.0255)
    assert words.loose([sure]) == ()
    (said,) = words.loose([sure, open_one])
    assert said == "The size of stiction is loose: its 95 % interval is wider than the size."
    (said,) = words.loose([open_one, open_one])
    assert said.startswith("The sizes of stiction and stiction are loose")
    assert words.loose([told_size(0.1, 0.05, (100.0, 10.0))]) == ()
    assert words.loose([told_size(0.1, 0.01, (100.0, 30.0))]) == ()
    assert words.loose([told_size(0.1, 0.05, (100.0, 30.0))])
