"""Readings that a device holds: free runs judge them, and their coloured steps mislead nobody."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from diagnose_motors import clean_case, settled
from diagnose_records import FOUND

from nxt_twin.diagnose.engine import diagnose, problem_for
from nxt_twin.diagnose.fitting.baselines import standing
from nxt_twin.diagnose.inquiry import _errs_in_colour, _misled
from nxt_twin.physics.simulate import Simulator

HELD_S = 0.08


def held(recording):
    """The recording with its count refreshed every `HELD_S` seconds alone."""
    refreshed_s = np.floor(recording.time_s / HELD_S) * HELD_S
    rows = np.searchsorted(recording.time_s, refreshed_s + 1e-9, side="right") - 1
    count = recording.columns["a_tacho_deg"][np.maximum(rows, 0)]
    return replace(recording, columns={**recording.columns, "a_tacho_deg": count})


@pytest.fixture(scope="module")
def case():
    whole = clean_case(42)
    return replace(
        whole, recordings=tuple(map(held, whole.recordings)), holdout=tuple(map(held, whole.holdout))
    )


def test_free_runs_leave_out_no_reading_because_it_is_held(case):
    with Simulator(problem_for(case).plant.layout) as simulator:
        _, fitter, final = settled(simulator, case)
        noise = replace(final.noise, reading_std=1e-3)
        plain = standing(fitter, final.plant, noise)
        holding = standing(fitter, final.plant.with_effect("sample_hold", {"refresh_period": HELD_S}), noise)
    assert holding.believed == plain.believed


def test_readings_held_for_eighty_milliseconds_are_named(case):
    found = diagnose(case).diagnosis
    assert [effect.id for effect in found.effects] == ["sample_hold"]
    assert found.effects[0].params["refresh_period_s"].value == pytest.approx(HELD_S, rel=0.15)


@pytest.mark.parametrize(("terms", "misled"), [({"outlier": None}, True), ({"scatter": None}, False)])
def test_coloured_steps_mislead_but_for_those_of_held_readings(terms, misled):
    record = replace(FOUND, moved=9.0, colour=9.0)
    effect = SimpleNamespace(holds_readings="scatter" in terms, terms=terms, equation_of="timing")
    evidence = SimpleNamespace(record=record, explanation=SimpleNamespace(found=((effect, None),)))
    assert _misled(evidence) is misled


@pytest.mark.parametrize(
    ("nearer", "colour", "misled"), [(0.51, 1.41, True), (0.5, 1.41, False), (0.51, 1.4, False)]
)
def test_coloured_steps_mislead_to_effects_that_leave_most_of_the_error(nearer, colour, misled):
    record = replace(FOUND, nearer=nearer, colour=colour)
    effect = SimpleNamespace(holds_readings=False, terms={"outlier": None}, equation_of="torque_balance")
    evidence = SimpleNamespace(record=record, explanation=SimpleNamespace(found=((effect, None),)))
    assert _misled(evidence) is misled


@pytest.mark.parametrize(
    ("term", "remaining", "misled"), [("outlier", 1.0, False), ("outlier", 1.01, True), ("force", 1.0, True)]
)
def test_late_stamps_that_leave_less_than_the_tolerance_mislead_no_steps(term, remaining, misled):
    record = replace(FOUND, nearer=1.02, colour=2.0, remaining=remaining)
    effect = SimpleNamespace(holds_readings=False, terms={term: None}, equation_of="timing")
    evidence = SimpleNamespace(record=record, explanation=SimpleNamespace(found=((effect, None),)))
    assert _misled(evidence) is misled


@pytest.mark.parametrize(
    ("changes", "misled"),
    [({}, True), ({"remaining": 3.0}, False), ({"colour": 1.4}, False), ({"found": True}, False)],
)
def test_coloured_steps_that_call_for_nothing_mislead_where_windows_err(changes, misled):
    record = replace(FOUND, found=False, remaining=3.01, colour=1.41)
    assert _errs_in_colour(replace(record, **changes)) is misled
