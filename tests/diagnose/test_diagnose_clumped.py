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


@pytest.mark.parametrize(("rows", "lost"), [(0.0, True), (2.0, False)])
def test_rows_that_were_not_read_evenly_are_not_taken_for_lost_counts(rows, lost):
    problem = problem_for(concealed((), seed=11))
    signals = replace(problem.signals[0], clump_rows=rows)
    assert ("missed_counts" in {one.id for one in addable_effects(problem.plant, signals)}) is lost
