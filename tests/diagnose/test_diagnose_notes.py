"""What a diagnosis says beside its figures, where they would mislead."""

from dataclasses import replace

import pytest
from diagnose_cases import LETS_GO, LONG, TWISTING, concealed, diagnosed

from nxt_twin.diagnose.diagnosis import Fit
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.diagnose.telling.notes import briefly_recorded, late_by_its_poll
from nxt_twin.diagnose.telling.words import sentence
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.configs import load_plant_config


def remarks_on_letting_go(notes):
    return [note for note in notes if "without current" in note]


def test_a_clean_motor_that_only_the_held_out_recording_lets_go_is_said_to_be_judged_on_what_was_not_fitted():
    found = diagnosed((), **LETS_GO).diagnosis
    assert found.verdict == "adequate"
    assert found.fit.improved > 1.0  # two tolerances
    (remark,) = remarks_on_letting_go(found.notes)
    assert remark.startswith("In r3.csv the motor runs")
    assert "Record such coast-downs" in remark


@pytest.mark.slow
def test_what_to_record_next_is_then_a_program_that_lets_it_go():
    case = concealed(("shaft_compliance",), **TWISTING)
    found = diagnose(replace(case, recordings=case.recordings[:2], holdout=case.recordings[2:])).diagnosis
    assert found.verdict == "explained"
    proposed = found.next_experiment
    assert "coast down without current" in proposed.input
    segments = [segment for run in proposed.program.runs for segment in run.segments]
    assert sum(segment.duration_s for segment in segments if segment.mode == "coast") > 5.0


def test_nothing_of_it_where_such_a_recording_was_fitted():
    case = concealed((), **LETS_GO)
    mixed = replace(case, recordings=(*case.recordings[1:], *case.holdout), holdout=case.recordings[:1])
    found = diagnose(mixed).diagnosis
    assert found.verdict == "adequate"
    assert not remarks_on_letting_go(found.notes)


@pytest.mark.parametrize(("improved", "falls"), [(3.0, True), (15.0, False)])
def test_an_error_is_said_to_fall_only_where_it_does(improved, falls):
    effect = diagnosed(("gravity_load",), **LONG).diagnosis.effects[0]
    fit = Fit(metric="free-run RMSE", unit="deg", baseline=10.0, improved=improved, floor=1.0)
    said = sentence("explained", [effect], fit)
    assert said.startswith(f"The model leaves out {effect.name}")
    assert ("falls from 10 to 3 deg" in said) == falls
    assert ("simulation of held-out data does not (10 deg off, now 15)" in said) != falls


@pytest.mark.parametrize(("fitted_s", "told"), [(1.9, True), (5.99, True), (6.0, False), (120.0, False)])
def test_less_than_six_seconds_are_said_to_be_too_little(fitted_s, told):
    remarks = briefly_recorded(fitted_s)
    assert bool(remarks) == told
    assert all(f"last {fitted_s:.2g} s" in remark and "at least 6 s" in remark for remark in remarks)


def test_a_diagnosis_of_short_recordings_carries_the_remark():
    case = concealed((), seed=11, seconds=2.0)
    assert any("at least 6 s" in note for note in diagnose(case).diagnosis.notes)


@pytest.mark.parametrize(
    ("share", "said"), [(0.51, "later the longer"), (0.49, None), (-0.49, None), (-0.51, "sooner the longer")]
)
def test_a_delay_that_goes_with_its_poll_is_told_as_the_logger_s(share, said):
    motor = plant_from_config(load_plant_config("nxt_motor"), "power_pct")
    told = late_by_its_poll(motor.with_effect("command_delay", {"command_delay": 0.01, "poll_share": share}))
    assert (said is None) is (told == ())
    assert said is None or said in told[0]
    assert late_by_its_poll(motor) == ()
