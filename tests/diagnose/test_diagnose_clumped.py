"""Recordings whose rows a link handed over in clumps, under the stamps of when they came."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose_cases import concealed

from nxt_twin.diagnose.engine import diagnose, problem_for
from nxt_twin.diagnose.search.trials import addable_effects
from nxt_twin.recording.recording import Recording


def in_clumps(case, size):
    """The case with rows that come so many at once."""

    def handed_over(recording):
        rows = np.arange(recording.rows)
        last = np.minimum(rows // size * size + size - 1, rows[-1])
        return Recording(
            recording.name, {**recording.columns, "time_s": recording.columns["time_s"][last]}, kinds=None
        )

    return replace(
        case,
        recordings=tuple(handed_over(one) for one in case.recordings),
        holdout=tuple(handed_over(one) for one in case.holdout),
    )


@pytest.mark.parametrize(
    ("effects", "size"),
    [
        pytest.param((), 4, marks=pytest.mark.slow),
        (("gravity_load",), 5),
        pytest.param(("end_stop",), 3, marks=pytest.mark.slow),
    ],
)
def test_a_motor_behind_a_link_that_clumps_rows_is_diagnosed_as_without(effects, size):
    case = concealed(effects, seed=11, seconds=12.0)
    plain, said = (diagnose(each).diagnosis for each in (case, in_clumps(case, size)))
    assert said.verdict == plain.verdict
    assert [one.id for one in said.effects] == list(effects) == [one.id for one in plain.effects]
    (told,) = [note for note in said.notes if "clumps" in note]
    assert f"about {size}:" in told
    assert not any("clumps" in note for note in plain.notes)


def by_timer(case, period_s):
    """The case with rows that a timer sends."""

    def sent(recording):
        time_s = (np.floor(recording.time_s / period_s) + 1.0) * period_s
        return Recording(recording.name, {**recording.columns, "time_s": time_s}, kinds=None)

    return replace(
        case,
        recordings=tuple(sent(one) for one in case.recordings),
        holdout=tuple(sent(one) for one in case.holdout),
    )


@pytest.mark.parametrize(
    ("effects", "seed", "period_s"),
    [
        pytest.param((), 12, 0.034, marks=pytest.mark.slow),
        (("gravity_load",), 11, 0.034),
        pytest.param(("coulomb_friction",), 12, 0.027, marks=pytest.mark.slow),
        pytest.param(("end_stop",), 11, 0.027, marks=pytest.mark.slow),
    ],
)
def test_a_motor_whose_rows_a_timer_sends_is_diagnosed_as_without(effects, seed, period_s):
    said = diagnose(by_timer(concealed(effects, seed=seed, seconds=12.0), period_s)).diagnosis
    assert said.verdict == ("explained" if effects else "adequate")
    assert [one.id for one in said.effects] == list(effects)
    (told,) = [note for note in said.notes if "clumps" in note]
    assert "ms. Better stamp" in told


@pytest.mark.parametrize(("rows", "there"), [(0.0, True), (2.0, False)])
def test_rows_that_were_not_read_evenly_are_not_taken_for_lost_counts_or_stale(rows, there):
    problem = problem_for(concealed((), seed=11))
    signals = replace(problem.signals[0], clump_rows=rows)
    found = {one.id for one in addable_effects(problem.plant, signals)}
    assert ("missed_counts" in found, "stale_samples" in found) == (there, there)
