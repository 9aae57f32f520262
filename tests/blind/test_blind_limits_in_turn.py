"""The verdict's limits set on some families and tried on another."""

import sys
from dataclasses import replace
from pathlib import Path

import pytest
from test_blind_by_family import judged, row_of

from nxt_twin.blind.limits_in_turn import Recorded, best_limits, limits_in_turn_rows, worth
from nxt_twin.diagnose.judging.verdict import LIMITS

sys.path.insert(0, str(Path(__file__).parents[1] / "diagnose"))
from diagnose_records import FOUND, QUIET

SURPRISED = replace(QUIET, surprise=1.3 * LIMITS.surprising)


def clean(family, record=QUIET):
    return Recorded(judged(family, "clean", verdict="adequate"), record)


def test_a_limit_that_is_too_low_elsewhere_is_moved_there_and_the_change_is_tried_here():
    elsewhere = [clean("mujoco", SURPRISED), clean("mujoco")]
    here = [clean("stiff", SURPRISED), Recorded(judged("stiff"), FOUND)]
    moved = best_limits(elsewhere)
    assert moved == replace(LIMITS, surprising=1.4 * LIMITS.surprising)
    row = row_of(limits_in_turn_rows([*elsewhere, *here]), "stiff")
    assert row["limits moved elsewhere"] == f"surprising {1.4 * LIMITS.surprising:g}"
    assert row["right as they are"].startswith("1/2")
    assert row["right with those"].startswith("2/2")


def test_no_limit_is_moved_without_need():
    assert best_limits([clean("mujoco"), Recorded(judged("mujoco"), FOUND)]) == LIMITS


def test_each_kind_of_case_weighs_as_much():
    singles = [Recorded(judged("mujoco"), FOUND)] * 3
    assert worth([*singles, clean("mujoco", SURPRISED)], LIMITS) == pytest.approx(0.5)
