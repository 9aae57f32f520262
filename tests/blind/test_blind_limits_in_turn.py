"""The verdict's limits set on some families and tried on another."""

from dataclasses import replace

import pytest
from test_blind_by_family import judged, row_of

from nxt_twin.blind.limits_in_turn import Recorded, best_limits, limits_in_turn_rows, worth
from nxt_twin.diagnose.judging.verdict import LIMITS, Record

QUIET = Record(
    named=0,
    found=False,
    left_nats=0.0,
    left_limit_nats=15.0,
    gained_nats=0.0,
    torque_before=1e-3,
    torque_after=1e-3,
    run_ratio=1.0,
    off=1.0,
    matters=True,
    worst_ratio=1.0,
    stalled_share=0.0,
    surprise=1.0,
    by_windows=False,
    nearer=1.0,
    silent=False,
    least_nats=100.0,
    remaining=10.0,
)
EFFECT = replace(
    QUIET, found=True, named=1, gained_nats=500.0, torque_before=2e-2, run_ratio=0.1, worst_ratio=0.1
)
SURPRISED = replace(QUIET, surprise=1.3 * LIMITS.surprising)


def clean(family, record=QUIET):
    return Recorded(judged(family, "clean", verdict="adequate"), record)


def test_a_limit_that_is_too_low_elsewhere_is_moved_there_and_the_change_is_tried_here():
    elsewhere = [clean("mujoco", SURPRISED), clean("mujoco")]
    here = [clean("stiff", SURPRISED), Recorded(judged("stiff"), EFFECT)]
    moved = best_limits(elsewhere)
    assert moved == replace(LIMITS, surprising=1.4 * LIMITS.surprising)
    row = row_of(limits_in_turn_rows([*elsewhere, *here]), "stiff")
    assert row["limits moved elsewhere"] == "surprising 5.6"
    assert row["right as they are"].startswith("1/2")
    assert row["right with those"].startswith("2/2")


def test_no_limit_is_moved_without_need():
    assert best_limits([clean("mujoco"), Recorded(judged("mujoco"), EFFECT)]) == LIMITS


def test_each_kind_of_case_weighs_as_much():
    singles = [Recorded(judged("mujoco"), EFFECT)] * 3
    assert worth([*singles, clean("mujoco", SURPRISED)], LIMITS) == pytest.approx(0.5)
