"""Stamps that a logger rounds to 5 ms: a diagnosis says what it says of fine ones, and tells the step."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose_cases import concealed

from nxt_twin.diagnose.engine import diagnose
from nxt_twin.recording.recording import Recording

STEP_S = 0.005


def rounded(case):
    """The case with stamps as a coarse clock writes them."""

    def written(recording):
        stamps_s = np.round(recording.columns["time_s"] / STEP_S) * STEP_S
        return Recording(recording.name, {**recording.columns, "time_s": stamps_s}, kinds=None)

    return replace(
        case,
        recordings=tuple(written(one) for one in case.recordings),
        holdout=tuple(written(one) for one in case.holdout),
    )


@pytest.mark.parametrize("effects", [(), ("gravity_load",)])
def test_rounded_stamps_change_no_answer(effects):
    case = concealed(effects, seed=11, seconds=12.0)
    plain, said = (diagnose(each).diagnosis for each in (case, rounded(case)))
    assert said.verdict == plain.verdict
    assert [one.id for one in said.effects] == list(effects) == [one.id for one in plain.effects]
    (told,) = [note for note in said.notes if "rounded" in note]
    assert "5 ms" in told
    assert not any("rounded" in note for note in plain.notes)
