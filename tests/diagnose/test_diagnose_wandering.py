"""Stamps that lag by a varying amount: drawn by these tests, in shapes that no truth family has."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose_cases import concealed
from diagnose_motors import clean_case
from diagnose_second_wave import has_second_wave
from hypothesis import given
from hypothesis import strategies as st

from nxt_twin.diagnose.engine import diagnose, problem_for
from nxt_twin.diagnose.fitting.lag_response import lag_wave
from nxt_twin.diagnose.fitting.wandering import second_wave_alone
from nxt_twin.physics.effects.timing import CLOCK_SKEW
from nxt_twin.physics.layout import Slot
from nxt_twin.recording.recording import Recording


def sawtooth(at_s):
    """Up for all but a twentieth of 4.3 s, then down."""
    part = (at_s / 4.3 + 0.3) % 1.0
    return np.where(part < 0.95, part / 0.95, (1.0 - part) / 0.05)


def two_tones(at_s):
    """Two sines, the periods of which have no common measure."""
    slow = np.sin(2.0 * np.pi * at_s / 5.1 + 0.4)
    return 0.5 + 0.3 * slow + 0.2 * np.sin(2.0 * np.pi * at_s / 1.87 + 2.0)


def late(case, course, span_s):
    """The case with the stamps of whole rows as late as `course` says, which goes from 0 to 1."""

    def stamped(recording):
        elapsed_s = recording.columns["time_s"] - recording.columns["time_s"][0]
        stamps_s = recording.columns["time_s"] + span_s * course(elapsed_s)
        return Recording(recording.name, {**recording.columns, "time_s": np.maximum.accumulate(stamps_s)})

    return replace(
        case,
        recordings=tuple(stamped(one) for one in case.recordings),
        holdout=tuple(stamped(one) for one in case.holdout),
    )


@pytest.mark.slow
@pytest.mark.parametrize("course", [sawtooth, two_tones])
def test_a_lag_of_whole_rows_is_named_whatever_its_course(course):
    case = late(concealed((), seed=2203, seconds=14.0), course, 0.09)
    said = diagnose(case).diagnosis
    assert said.verdict == "explained"
    assert [one.id for one in said.effects] == ["clock_skew"]
    assert said.effects[0].params["lag_span_s"].value == pytest.approx(0.09, rel=0.3)
    two_s = next(one for one in said.fit.horizons if one.seconds == 2.0)
    assert two_s.improved < 0.2 * two_s.baseline


@given(
    rise=st.floats(0.02, 0.98),
    straightness=st.floats(0.0, 1.0),
    phase=st.floats(-1.0, 1.0),
    at_s=st.floats(0.0, 60.0),
)
def test_the_search_draws_the_wave_that_a_simulation_draws(rise, straightness, phase, at_s):
    simulated = CLOCK_SKEW.terms["lag"](
        at_s, 2.0, 0.0, 1.4, phase, rise, straightness, 0.0, 2.0, 0.0, 1.0, 0.3
    )
    drawn = lag_wave(np.array([at_s / 1.4 + phase]), rise, straightness)
    np.testing.assert_allclose(drawn, simulated, atol=1e-9)


def quick_beat(at_s):
    """A sine of 1.57 s, and one of 0.68 s with a third of its size."""
    slow, quick = (np.sin(2.0 * np.pi * (at_s / period_s + 0.2)) for period_s in (1.57, 0.683))
    return 0.5 + 0.385 * slow + 0.115 * quick


@pytest.mark.slow
def test_a_quick_lag_of_two_waves_ends_with_the_larger_first():
    said = diagnose(late(concealed((), seed=2203, seconds=14.0), quick_beat, 0.03)).diagnosis
    assert [one.id for one in said.effects] == ["clock_skew"]
    found = said.effects[0].params
    assert found["lag_period_s"].value == pytest.approx(1.57, rel=0.03)
    assert found["lag_second_period_s"].value == pytest.approx(0.683, rel=0.03)


WAVES = {each.symbol: each.starts[0] * each.si for each in CLOCK_SKEW.parameters}


@pytest.mark.parametrize(("share", "leaves"), [(0.29, False), (0.31, True)])
def test_a_large_second_wave_is_tried_alone(share, leaves):
    both = {**WAVES, "lag_span": 0.1, "second_share": share, "second_period": 0.7, "second_phase": 0.2}
    plant = problem_for(clean_case(12)).plant.with_effect("clock_skew", both)
    alone = second_wave_alone(plant, CLOCK_SKEW)
    assert (alone is not None) is leaves
    if alone:
        found = {symbol: alone.values[Slot("clock_skew", symbol)] for symbol in WAVES}
        assert found["lag_span"] == pytest.approx(0.1 * share)
        assert (found["lag_period"], found["lag_phase"], found["second_share"]) == (0.7, 0.2, 0.0)


@pytest.mark.parametrize(
    ("promised", "gained", "taken"), [(7.6, 15.1, True), (7.4, 99.0, False), (99.0, 14.9, False)]
)
def test_a_second_wave_has_to_promise_and_to_gain(promised, gained, taken):
    assert has_second_wave(promised, gained) is taken
