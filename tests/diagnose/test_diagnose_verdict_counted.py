"""What a verdict makes of nats that readings share, of errors that only some readings show, and of clocks."""

import math
from dataclasses import replace

import pytest
from diagnose_records import FOUND, QUIET

from nxt_twin.diagnose.judging.verdict import (
    counted_once,
    is_forgiven,
    is_needless,
    is_stalled,
    is_unseen,
    may_be_superfluous,
    verdict_of,
)

WANDERING = replace(
    FOUND,
    of_readings=True,
    run_ratio=0.8,
    torque_before=0.15,
    torque_after=0.025,
    remaining=5.0,
    surprise=0.9,
    nearer=0.49,
)


@pytest.mark.parametrize(("colour", "nats"), [(4.0, 25.0), (1.0, 100.0), (0.8, 100.0), (math.inf, 100.0)])
def test_readings_that_tell_of_one_another_count_once(colour, nats):
    assert counted_once(replace(FOUND, colour=colour, least_nats=100.0)).least_nats == nats


@pytest.mark.parametrize(
    ("changes", "needless"),
    [({}, True), ({"nearer": 1.05}, False), ({"doubts": True}, False), ({"of_readings": False}, False)],
)
def test_a_fault_of_the_readings_beside_which_a_motor_simulates_worse_is_needless(changes, needless):
    loud = replace(FOUND, nearer=1.051, of_readings=True, least_nats=5000.0, at_first=5.0)
    assert is_needless(replace(loud, **changes)) is needless


@pytest.mark.parametrize(("least_nats", "weighed"), [(99.9, True), (100.0, False)])
def test_only_what_little_speaks_for_is_weighed_beside_the_others(least_nats, weighed):
    assert may_be_superfluous(replace(FOUND, named=2, least_nats=least_nats)) is weighed


@pytest.mark.parametrize(
    ("changes", "needless"),
    [
        ({}, False),
        ({"run_ratio": 0.51}, True),
        ({"at_check": 0.99}, True),
        ({"nearer": 0.99, "least_nats": 39.0}, True),
    ],
)
def test_an_effect_that_checking_simulations_need_is_not_needless_where_held_out_ones_do_without(
    changes, needless
):
    payload = replace(
        FOUND, nearer=0.86, longer=1.0, at_first=0.8, at_check=1.0, run_ratio=0.5, least_nats=300.0
    )
    assert is_needless(replace(payload, **changes)) is needless


@pytest.mark.parametrize(
    ("changes", "unseen"),
    [
        ({}, True),
        ({"surprise": 5.0}, False),
        ({"at_check": 3.01}, False),
        ({"matters": False}, False),
    ],
)
def test_an_error_that_only_held_out_readings_show_is_told_apart(changes, unseen):
    record = replace(QUIET, surprise=5.01, at_check=3.0)
    assert is_unseen(replace(record, **changes)) is unseen


def test_a_found_effect_explains_what_checks_before_held_out_readings_alone_surprise():
    found = replace(FOUND, surprise=6.0, run_ratio=0.2, at_check=15.0, nearer=1.0)
    assert verdict_of(found) == "unexplained"
    assert is_unseen(found)
    assert not is_unseen(replace(found, at_check=15.1))


@pytest.mark.parametrize(
    ("changes", "stalled"),
    [
        ({}, False),
        ({"nearer": 0.151}, True),
        ({"run_ratio": 0.151}, True),
        ({"named": 0}, False),
        ({"named": 2, "least_nats": 200.0}, True),
    ],
)
def test_no_stall_explains_an_error_that_one_effect_takes_away(changes, stalled):
    record = replace(FOUND, stalled_share=0.2, nearer=0.15, run_ratio=0.15)
    assert is_stalled(replace(record, **changes)) is stalled


@pytest.mark.parametrize(
    ("changes", "verdict"),
    [
        ({}, "explained"),
        ({"torque_before": 0.12}, "unexplained"),
        ({"nearer": 0.5}, "unexplained"),
        ({"surprise": 1.0}, "unexplained"),
        ({"sober_nats": 300.0}, "explained"),
    ],
)
def test_a_clock_that_takes_most_of_a_torque_away_may_leave_some(changes, verdict):
    assert verdict_of(replace(WANDERING, **changes)) == verdict


def test_faults_of_readings_that_leave_a_torque_and_the_error_are_forgiven_nothing():
    assert not is_forgiven(WANDERING)
    assert is_forgiven(replace(WANDERING, nearer=0.5))
