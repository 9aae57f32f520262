"""Each limit of the verdict: on either side of it the answer is another."""

from dataclasses import fields, replace

import pytest
from diagnose_records import FOUND, QUIET

from nxt_twin.diagnose.judging.verdict import (
    LIMITS,
    VerdictLimits,
    is_another_law,
    is_contradicted,
    is_forgiven,
    is_idle,
    is_needless,
    is_spoiled,
    is_superfluous,
    is_swallowed,
    verdict_of,
)

STRUCTURED = replace(QUIET, left_nats=100.0, torque_after=1.0)
FORGIVEN = replace(FOUND, matters=False, remaining=3.01)
WANDERING = replace(
    FOUND, of_readings=True, run_ratio=0.8, torque_before=0.1, remaining=5.0, surprise=0.9, nearer=0.4
)
ABOVE = 1.01

# Numbers, and not the limits themselves: a limit that is moved fails its test.
EDGES = {
    "structured_torque": (replace(STRUCTURED, torque_after=8.5e-3, remaining=3.0), "torque_after"),
    "excused": (replace(QUIET, torque_after=6e-3, remaining=3.01), "torque_after"),
    "rested": (replace(FOUND, rested_nats=60.0, remaining=0.1, matters=False), "rested_nats"),
    "moved": (replace(FOUND, moved=3.0), "moved"),
    "most_left": (
        replace(FOUND, left_nats=100.0, torque_after=1e-2, gained_nats=100.0 / 0.14 - 100.0),
        "left_nats",
    ),
    "hardly": (replace(FOUND, surprise=100.0, nearer=0.15), "nearer"),
    "chance": (replace(FOUND, leaves_most=True, by_chance=True, surprise=2.1), "surprise"),
    "most_stalled": (replace(FOUND, stalled_share=0.15), "stalled_share"),
    "confirmed": (
        replace(FOUND, by_windows=True, colour=1.0, remaining=3.01, nearer=0.5),
        "nearer",
    ),
    "cleared": (
        replace(WANDERING, torque_after=0.02),
        "torque_after",
    ),
    "hardly_any": (replace(FOUND, kin_nats=30.0, remaining=2.9, nearer=0.06, run_ratio=0.06), "nearer"),
    "sober": (replace(FOUND, sober_nats=60.0, gained_nats=360.0, remaining=0.6, matters=False), "sober_nats"),
    "surprising": (replace(FOUND, surprise=5.0, run_ratio=0.5), "surprise"),
    "surprising_by_windows": (replace(QUIET, by_windows=True, surprise=1.0), "surprise"),
    "forgiven": (replace(FORGIVEN, torque_after=1.5e-2, torque_before=2.9e-2), "torque_after"),
    "unforgiven": (replace(FORGIVEN, torque_after=2e-2, torque_before=1.0), "torque_after"),
    "large_by_windows": (replace(QUIET, by_windows=True, torque_after=2.8e-2), "torque_after"),
}


@pytest.mark.parametrize("limit", sorted(EDGES))
def test_just_above_a_limit_the_verdict_is_another_than_at_it(limit):
    at, key = EDGES[limit]
    beyond = replace(at, **{key: ABOVE * getattr(at, key)})
    assert verdict_of(at) == ("explained" if at.found else "adequate")
    assert verdict_of(beyond) == "unexplained"


@pytest.mark.parametrize("limit", sorted(EDGES))
def test_a_limit_that_is_moved_moves_the_verdict(limit):
    at, _ = EDGES[limit]
    tighter = replace(LIMITS, **{limit: 0.98 * getattr(LIMITS, limit)})
    if limit == "most_left":
        tighter = replace(LIMITS, most_left=0.9 * LIMITS.most_left)
    assert verdict_of(at, tighter) == "unexplained"


def test_more_effects_than_are_likely_to_be_missing_at_once_are_refused():
    assert verdict_of(replace(FOUND, named=LIMITS.most_named)) == "explained"
    assert verdict_of(replace(FOUND, named=LIMITS.most_named + 1)) == "unexplained"


def test_each_limit_has_a_case_at_its_edge():
    assert {field.name for field in fields(VerdictLimits)} == {
        *EDGES,
        "most_named",
        "idle",
        "no_nearer",
        "silent",
        "faint",
        "sure",
        "unheard",
        "unmistakable",
        "heard",
        "loud",
        "worse",
        "nearly",
        "shaped",
        "half_shaped",
        "coloured",
    }


@pytest.mark.parametrize("changes", [{"remaining": 3.0}, {"by_windows": True}, {"matters": False}])
def test_an_unknown_torque_excuses_a_small_error_and_what_windows_of_coloured_readings_leave(changes):
    pushed = replace(QUIET, torque_after=2.7e-2, remaining=3.01)
    assert verdict_of(pushed) == "unexplained"
    assert verdict_of(replace(pushed, **changes)) == "adequate"


@pytest.mark.parametrize(
    ("changes", "contradicted"),
    [
        ({}, True),
        ({"colour": 1.4}, False),
        ({"nearer": 0.5}, False),
        ({"remaining": 3.0}, False),
        ({"by_windows": False}, False),
        ({"found": False}, False),
    ],
)
def test_windows_alone_name_nothing_where_single_steps_are_evidence_too(changes, contradicted):
    alone = replace(FOUND, by_windows=True, colour=1.39, nearer=0.51, remaining=3.01)
    record = replace(alone, **changes)
    assert is_contradicted(record) is contradicted
    assert verdict_of(record) == (
        "unexplained" if contradicted else "explained" if record.found else "adequate"
    )


@pytest.mark.parametrize(("kin_nats", "another"), [(18.0, False), (18.1, True)])
def test_a_drag_or_a_spring_beside_which_another_sets_in_somewhere_is_refused_unless_hardly_an_error_is_left(
    kin_nats, another
):
    record = replace(FOUND, kin_nats=kin_nats, remaining=0.1, matters=False)
    assert is_another_law(record) is another
    assert verdict_of(record) == ("unexplained" if another else "explained")
    assert not is_another_law(replace(record, found=False))
    near = replace(record, nearer=0.06, run_ratio=0.06)
    assert not is_another_law(near)
    assert is_another_law(replace(near, remaining=3.01)) is another
    assert is_another_law(replace(near, run_ratio=0.061)) is another


@pytest.mark.parametrize(
    ("changes", "another"),
    [
        ({}, True),
        ({"kin_nats": 9.0}, False),
        ({"remaining": 1.0}, False),
        ({"nearer": 0.15}, False),
        ({"nearer": 0.0, "run_ratio": 0.16}, True),
    ],
)
def test_half_of_that_refuses_a_drag_that_leaves_a_good_part_of_an_error_that_matters(changes, another):
    record = replace(replace(FOUND, kin_nats=9.1, remaining=1.1, nearer=0.16), **changes)
    assert is_another_law(record) is another
    assert verdict_of(record) == ("unexplained" if another else "explained")


def test_what_goes_with_the_time_at_rest_speaks_against_a_found_effect_alone():
    assert verdict_of(replace(QUIET, rested_nats=100.0)) == "adequate"
    assert verdict_of(replace(FOUND, rested_nats=100.0, remaining=0.1)) == "unexplained"


def test_what_surprises_on_held_out_readings_is_missing_whether_or_not_an_effect_was_found():
    assert verdict_of(replace(QUIET, surprise=0.99 * 5.0)) == "adequate"
    assert verdict_of(replace(QUIET, surprise=ABOVE * 5.0)) == "unexplained"


@pytest.mark.parametrize(
    ("changes", "idle"),
    [
        ({}, True),
        ({"nearer": 0.99 * 0.85}, False),
        ({"named": 1}, False),
        ({"matters": False}, False),
        ({"least_nats": 999.0}, True),
        ({"least_nats": 1000.0}, False),
    ],
)
def test_several_effects_that_bring_no_simulation_nearer_are_idle(changes, idle):
    several = replace(FOUND, named=2, nearer=ABOVE * 0.85)
    assert is_idle(replace(several, **changes)) is idle


@pytest.mark.parametrize(
    ("changes", "spoiled"),
    [
        ({}, True),
        ({"nearer": 0.99 * LIMITS.worse}, False),
        ({"named": 1}, False),
        ({"matters": False}, False),
        ({"least_nats": 199.0}, True),
        ({"least_nats": 201.0}, False),
    ],
)
def test_of_several_effects_that_predict_unseen_readings_worse_than_none_one_may_go(changes, spoiled):
    several = replace(FOUND, named=2, nearer=ABOVE * LIMITS.worse)
    assert is_spoiled(replace(several, **changes)) is spoiled


@pytest.mark.parametrize(
    ("changes", "needless"),
    [
        ({}, True),
        ({"nearer": 0.99 * 0.98}, False),
        ({"least_nats": 40.0}, False),
        ({"found": False}, False),
        ({"nearer": 0.3, "at_first": 1.59}, True),
        ({"nearer": 0.3, "at_first": 1.6}, False),
        ({"nearer": 0.3, "at_first": 1.59, "named": 2}, False),
        ({"nearer": 0.3, "at_first": 0.49, "named": 2}, True),
        ({"nearer": 0.3, "at_first": 0.5, "named": 2}, False),
        ({"nearer": 0.3, "at_first": 1.59, "least_nats": 40.0}, False),
        ({"restores": True}, False),
    ],
)
def test_an_effect_without_which_a_simulation_errs_by_no_more_is_needless(changes, needless):
    quiet = replace(FOUND, nearer=0.98, longer=0.84, least_nats=0.99 * 40.0)
    assert is_needless(replace(quiet, **changes)) is needless


@pytest.mark.parametrize(
    ("changes", "needless"),
    [
        ({}, True),
        ({"at_first": 1.0}, False),
        ({"nearer": 0.85}, False),
        ({"longer": 0.84}, False),
        ({"longer": 0.86}, True),
        ({"doubts": True}, False),
        ({"restores": True}, False),
        ({"found": False}, False),
        ({"least_nats": 1001.0}, False),
    ],
)
def test_no_ordinary_gain_names_what_hardly_changes_a_simulation_that_errs_by_less_than_matters(
    changes, needless
):
    loud = replace(FOUND, nearer=0.86, at_first=0.99, least_nats=999.0)
    assert is_needless(replace(loud, **changes)) is needless


@pytest.mark.parametrize(
    ("changes", "needless"),
    [
        ({}, True),
        ({"least_nats": 100.0}, False),
        ({"least_nats": 1e6, "moved": 3.0}, False),
        ({"least_nats": 1e6, "moved": 3.01}, True),
        ({"least_nats": 1e6, "moved": 3.01, "nearer": 0.85}, False),
        ({"least_nats": 1e6, "moved": 3.01, "doubts": True}, False),
        ({"nearer": 0.85}, False),
        ({"longer": 0.84}, False),
        ({"doubts": True}, False),
        ({"restores": True}, False),
    ],
)
def test_only_a_clear_gain_names_what_hardly_brings_a_simulation_nearer(changes, needless):
    quiet = replace(FOUND, nearer=0.86, longer=1.0, at_first=5.0, least_nats=99.9)
    assert is_needless(replace(quiet, **changes)) is needless


@pytest.mark.parametrize(
    ("changes", "superfluous"),
    [
        ({}, True),
        ({"worst_ratio": 1.05}, False),
        ({"worst_ratio": 1.05, "nearer": 0.98, "least_nats": 39.9}, True),
        ({"nearer": 0.85}, False),
        ({"least_nats": 100.0}, False),
        ({"named": 1}, False),
        ({"restores": True}, False),
        ({"at_first": 0.49}, True),
    ],
)
def test_the_weakest_of_several_effects_is_weighed_beside_the_others(changes, superfluous):
    beside = replace(FOUND, named=2, nearer=0.86, longer=0.84, worst_ratio=1.06, least_nats=99.9)
    assert is_superfluous(replace(beside, **changes)) is superfluous


@pytest.mark.parametrize(
    ("changes", "forgiven"),
    [
        ({}, True),
        ({"remaining": 3.0}, False),
        ({"torque_after": 1.5e-2}, False),
        ({"torque_before": 7.4e-2}, True),
        ({"torque_before": 7.6e-2}, False),
        ({"by_windows": True}, False),
        ({"by_windows": True, "torque_after": 2.8e-2}, False),
        ({"by_windows": True, "torque_after": 2.81e-2}, True),
        ({"found": False}, False),
    ],
)
def test_an_unknown_torque_that_the_effects_leave_does_not_excuse_their_error(changes, forgiven):
    record = replace(replace(FORGIVEN, torque_after=1.51e-2, torque_before=3e-2), **changes)
    assert is_forgiven(record) is forgiven
    assert verdict_of(record) == ("unexplained" if forgiven else "explained" if record.found else "adequate")


@pytest.mark.parametrize(
    ("changes", "forgiven"),
    [({}, True), ({"named": 2}, False), ({"torque_after": 6e-3}, False), ({"of_readings": True}, False)],
)
def test_three_effects_that_leave_a_torque_and_an_error_stand_for_another(changes, forgiven):
    record = replace(FORGIVEN, named=3, torque_after=6.01e-3, torque_before=1.0)
    assert is_forgiven(replace(record, **changes)) is forgiven


@pytest.mark.parametrize(
    ("changes", "forgiven"),
    [({}, False), ({"nearer": 0.151}, True), ({"run_ratio": 0.151}, True), ({"torque_before": 0.66}, True)],
)
def test_a_large_torque_is_excused_where_nearly_all_of_it_and_of_the_error_is_gone(changes, forgiven):
    record = replace(FORGIVEN, torque_after=0.1, torque_before=0.67, nearer=0.15, run_ratio=0.15)
    assert is_forgiven(replace(record, **changes)) is forgiven


def test_effects_that_leave_hardly_any_error_need_not_explain_the_rest():
    surprising = replace(FOUND, surprise=100.0, nearer=0.1501, run_ratio=0.1501)
    assert verdict_of(surprising) == "unexplained"
    assert verdict_of(replace(surprising, nearer=0.15)) == "explained"
    assert verdict_of(replace(surprising, run_ratio=0.0)) == "unexplained"


@pytest.mark.parametrize(
    ("changes", "verdict"),
    [
        ({}, "explained"),
        ({"nearer": 0.5}, "unexplained"),
        ({"surprise": 1.0}, "unexplained"),
        ({"sober_nats": 1e3}, "explained"),
        ({"sober_nats": 1e3, "surprise": 1.0}, "unexplained"),
    ],
)
def test_faults_of_readings_that_clear_most_of_the_torque_may_leave_some(changes, verdict):
    record = EDGES["cleared"][0]
    assert verdict_of(replace(record, **changes)) == verdict


def test_what_was_refused_and_helps_explains_nothing():
    assert verdict_of(replace(FOUND, helps=True)) == "unexplained"


@pytest.mark.parametrize(
    ("changes", "swallowed"),
    [
        ({}, True),
        ({"sober_nats": 60.0}, False),
        ({"gained_nats": 375.0}, False),
        ({"gained_nats": -100.0}, True),
        ({"by_windows": True, "colour": 1.39}, True),
        ({"by_windows": True, "colour": 1.4}, False),
        ({"colour": 1.4}, True),
        ({"restores": True}, False),
        ({"found": False}, False),
        ({"remaining": 0.51}, True),
        ({"remaining": 0.5}, False),
        ({"remaining": 1.0, "of_readings": True}, False),
        ({"remaining": 1.01, "of_readings": True}, True),
        ({"remaining": 3.0, "nearer": 0.06, "run_ratio": 0.06}, False),
        ({"remaining": 3.01, "nearer": 0.06, "run_ratio": 0.06}, True),
    ],
)
def test_an_unknown_torque_may_not_stand_for_a_law_that_readings_call_for(changes, swallowed):
    record = replace(replace(FOUND, sober_nats=60.1, gained_nats=360.0), **changes)
    assert is_swallowed(record) is swallowed
    assert is_another_law(record) is swallowed


@pytest.mark.parametrize("left", ["leaves_most", "loose"])
def test_effects_that_leave_most_of_an_error_or_are_loose_explain_nothing_that_matters(left):
    record = replace(FOUND, **{left: True})
    assert verdict_of(record) == "unexplained"


@pytest.mark.parametrize(("surprise", "verdict"), [(2.1, "explained"), (2.11, "unexplained")])
def test_counts_lost_by_chance_may_leave_most_of_an_error_that_is_no_surprise(surprise, verdict):
    record = replace(FOUND, leaves_most=True, by_chance=True, surprise=surprise)
    assert verdict_of(record) == verdict
    assert verdict_of(replace(record, by_chance=False)) == "unexplained"


def test_a_loose_size_is_no_objection_where_no_error_that_matters_is_left():
    assert verdict_of(replace(FOUND, loose=True, remaining=1.0)) == "explained"
    assert verdict_of(replace(FOUND, loose=True, remaining=1.01)) == "unexplained"


def test_three_effects_are_the_most_that_are_likely_to_be_missing_at_once():
    assert LIMITS.most_named == 3
