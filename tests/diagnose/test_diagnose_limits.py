"""Each limit of the search and of its effort: on either side of it, a few hundredths apart, the answer is another."""

from dataclasses import fields
from types import SimpleNamespace

import pytest
from diagnose_anew import searched_from
from diagnose_limits import (
    against_a_hidden_load,
    begun_by,
    belief,
    comb,
    effect_named,
    effects_grown,
    forward,
    is_heard,
    is_kept,
    is_late,
    is_near,
    is_rough,
    is_taken,
    lasts,
    leaders,
    likelier,
    losses,
    most_beside,
    restored,
    rival_is_worse,
    rivals_of,
    rounds,
    rugged,
    shared_anew_with,
    sober_std,
    structure,
    swapped,
)
from diagnose_second_wave import has_second_wave
from test_diagnose_twins import rival

from nxt_twin.diagnose.search.limits import SearchEffort, SearchLimits
from nxt_twin.diagnose.search.trials import _may_lead
from nxt_twin.physics.effects.transmission import BACKLASH
from nxt_twin.physics.library import library

OWN = effect_named(source="our own curve")
EDGES = {
    "second_nats": (lambda _, v: has_second_wave(99.0, v), 14.9, 15.1),
    "second_promised": (lambda _, v: has_second_wave(v, 99.0), 7.4, 7.6),
    "gain_nats": (lambda _, v: likelier(v), 7.9, 8.1),
    "silent_nats": (lambda _, v: likelier(v, silent=True), 11.9, 12.1),
    "windows_nats": (lambda _, v: likelier(v, by_windows=True), 11.9, 12.1),
    "check_nats": (lambda _, v: likelier(99.0, check=v), 1.9, 2.1),
    "half": (lambda _, v: likelier(v, check=20.0), 3.9, 4.1),
    "altogether": (lambda _, v: likelier(6.0, check=v), 5.9, 6.1),
    "form_share": (lambda _, v: likelier(v, explained=1e3), 39.0, 41.0),
    "idle_share": (lambda _, v: likelier(v, explained=1e3, silent=True), 247.0, 253.0),
    "nearer": (lambda _, v: likelier(99.0, explained=1e3, silent=True, ratio=v), 0.74, 0.76),
    "much_nearer": (lambda _, v: likelier(25.0, explained=1e3, ratio=v), 0.49, 0.51),
    "much_nearer_share": (lambda _, v: likelier(v - 2.5, explained=1e3, ratio=0.4), 19.7, 20.3),
    "many_nats": (lambda _, v: lasts(v, 0.0), 99.0, 101.0),
    "few_moments": (lambda _, v: lasts(9.0, v), 3.45, 3.55),
    "loud_nats": (lambda patch, v: is_heard(patch, check=v), 39.0, 41.0),
    "recurring_nats": (lambda _, v: lasts(9.0, 1.0, check=v, ratio=0.9), 29.9, 30.1),
    "odd_tolerances": (lambda _, v: lasts(1e4, 9.0, v, 7.9), 1.98, 2.02),
    "late_polls": (lambda _, v: is_late(v), 0.24, 0.26),
    "keep_nats": (is_kept, 2.95, 3.05),
    "swap_nats": (lambda _, v: swapped(v) is None, -0.98, -1.02),
    "rival_nats": (lambda _, v: is_near(v), 7.9, 8.1),
    "twin_nats": (lambda _, v: is_near(v, is_twin=True), 148.0, 152.0),
    "rival_ratio": (rival_is_worse, 1.025, 1.035),
    "sure_rival_ratio": (lambda patch, v: rival_is_worse(patch, v, -150.0, ("twist",)), 1.29, 1.31),
    "sure_nats": (lambda patch, v: rival_is_worse(patch, 1.2, v, ("twist",)), -99.0, -101.0),
    "told_nats": (lambda patch, v: rival(patch, v, found="load").behind > 0.0, 10.1, 9.9),
    "own_moment_nats": (begun_by, 11.9, 12.1),
    "better_nats": (lambda _, v: is_taken(v), 0.98, 1.02),
    "rival_reach_nats": (lambda _, v: rivals_of(0.0, v), 39.5, 40.5),
    "far_reach_nats": (lambda _, v: rivals_of(v), 398.0, 402.0),
    "slack_nats": (lambda _, v: forward(100.0, -v)["within"], 9.9, 10.1),
    "settled_share": (lambda _, v: forward(100.0, -99.0, v)["within"], 9.9, 10.1),
    "in_reach": (lambda _, v: forward(100.0, *[-99.0] * 5, v, states=("twist",))["within"], 24.5, 25.5),
    "lifted": (lambda _, v: leaders(v), 39.5, 40.5),
    "restoring_nats": (lambda _, v: restored(v), 1.48, 1.52),
    "fine": (is_rough, 1.48, 1.52),
    "comb": (lambda _, v: comb(v) > 0.0, 4, 5),
    "shared_nats": (lambda _, v: not _may_lead(structure(cost=v), 0.0), 149.0, 151.0),
}
STATED = SimpleNamespace(
    plain=True, parameters=(SimpleNamespace(frozen=True),), source="a book", commoner_nats=0.0
)
COUNTS = {
    "left_out_nats": (lambda _: belief(STATED), 3.0),
    "coincidence_nats": (lambda _: against_a_hidden_load(), [1.02, 0.0]),
    "most_effects": (lambda _: effects_grown(), 4),
    "rivals_drafted": (lambda _: rivals_of(*[0.0] * 9), 4),
    "short_list": (lambda _: rivals_of(known=9), 5),
    "leading": (lambda _: forward(100.0, 0.0, 0.0, 0.0)["within"], 2),
    "drafted": (lambda _: forward(1.0)["most"], 10),
    "promised": (lambda _: forward(1.0)["least"], pytest.approx(0.8)),
    "exchanges": (rounds, 5),
    "restoring": (lambda _: restored(10.1), 3),
    "rugged": (lambda _: rugged(20.0, 30.0, 40.0), 2),
    "losses": (lambda patch: len(losses(patch, 4.0, 3.0, 2.0, 1.0)), 3),
    "shares": (lambda _: len(shared_anew_with(BACKLASH, gain=9.0).tried) // 3, 3),
    "anew": (lambda patch: len(searched_from(patch, [None] * 7)[1]), 2),
    "beside": (lambda _: most_beside(), 2),
    "quiet": (lambda patch: searched_from(patch, [None])[2], [pytest.approx(0.02)]),
    "sober": (sober_std, pytest.approx(0.3)),
}


@pytest.mark.parametrize(
    ("costs", "settled"), [((-5.0, 59.0, -9.0), [2, 0, 1]), ((61.0, 59.0), [1]), ((61.0,), [])]
)
def test_a_share_of_lost_counts_is_settled_where_a_fit_may_still_make_it_likelier(
    monkeypatch, costs, settled
):
    assert losses(monkeypatch, *costs) == settled


@pytest.mark.parametrize(("cost", "begun"), [(7.9, True), (8.1, False)])
def test_moments_of_their_own_have_to_leave_fitted_readings_as_likely(monkeypatch, cost, begun):
    assert begun_by(monkeypatch, 99.0, cost=cost) is begun


@pytest.mark.parametrize(("gain", "times"), [(1.02, 5), (0.98, 1), (0.0, 1)])
def test_a_search_that_comes_back_to_where_it_has_grown_from_does_not_grow_again(monkeypatch, gain, times):
    assert rounds(monkeypatch, gain) == times


@pytest.mark.parametrize(
    ("check", "gain", "taken"), [(30.1, 41.0, True), (30.1, 29.0, False), (29.9, 41.0, False)]
)
def test_a_silent_effect_that_checking_readings_call_for_need_not_bring_a_simulation_nearer(
    check, gain, taken
):
    assert likelier(gain, check=check, explained=1e3, silent=True) is taken


@pytest.mark.parametrize(
    ("check", "shows", "kept"),
    [
        (8.1, ("low_speed", "reversal"), True),
        (7.9, ("low_speed", "reversal"), False),
        (8.1, ("high_load",), False),
    ],
)
@pytest.mark.parametrize(("moments", "error", "elsewhere"), [(9.0, 1.5, 0.0), (3.0, 2.1, 9.0)])
def test_friction_that_checking_readings_bear_out_may_act_where_a_motor_turns_back_once(
    check, shows, kept, moments, error, elsewhere
):
    assert lasts(99.0, moments, error, elsewhere, check=check, shows=shows) is kept


@pytest.mark.parametrize(
    ("ratio", "second", "kept"),
    [
        (0.99, "size", True),
        (1.0, "size", False),
        (0.99, "cycles_per_turn", False),
        (0.99, "lag_period_s", False),
    ],
)
@pytest.mark.parametrize(("error", "elsewhere"), [(2.1, 0.0), (1.5, 8.1)])
def test_what_checking_readings_call_for_loudly_may_come_from_few_moments_unless_it_has_a_period(
    ratio, second, kept, error, elsewhere
):
    assert lasts(99.0, 1.0, error, elsewhere, check=30.1, ratio=ratio, second=second) is kept


def test_what_gains_in_one_odd_second_alone_does_not_recur_however_loudly_it_checks():
    assert not lasts(190.0, 4.4, 1.5, 7.9, check=44.5, ratio=0.82)


@pytest.mark.parametrize(
    ("ratio", "share"), [(0.5, 0.04), (0.65, 0.04), (0.825, 0.145), (1.0, 0.25), (1.2, 0.25)]
)
def test_a_silent_simulation_asks_for_more_the_less_nearer_it_gets(ratio, share):
    assert not likelier(1e3 * share - 1.0, explained=1e3, silent=True, ratio=ratio, check=2.5)
    assert likelier(1e3 * share + 1.0, explained=1e3, silent=True, ratio=ratio, check=2.5)


@pytest.mark.parametrize(
    ("changes", "heard"),
    [
        ({}, True),
        ({"gain": 99.0}, False),
        ({"ratio": 0.51}, False),
        ({"error": 1.9}, False),
        ({"supersedes": ("coulomb_friction",)}, False),
        ({"small": True}, False),
    ],
)
def test_a_small_effect_has_a_name_where_readings_need_it_loudly(monkeypatch, changes, heard):
    assert is_heard(monkeypatch, **changes) is heard


@pytest.mark.parametrize("limit", sorted(EDGES))
def test_on_either_side_of_a_limit_the_answer_is_another(limit, monkeypatch):
    answer, below, above = EDGES[limit]
    assert answer(monkeypatch, below) != answer(monkeypatch, above)


@pytest.mark.parametrize("limit", sorted(COUNTS))
def test_so_many_are_tried(limit, monkeypatch):
    count, expected = COUNTS[limit]
    assert count(monkeypatch) == expected


@pytest.mark.parametrize(
    ("promised", "drafted", "settled"), [(8.1, 1.0, True), (7.9, 1.0, False), (99.0, -1.0, False)]
)
def test_an_effect_whose_draft_breaks_its_promise_is_settled_under_a_first_guess_of_the_noise(
    promised, drafted, settled
):
    assert rugged(promised, cost=drafted) == settled
    assert rugged(promised, cost=drafted, listed={"0"}) == 0
    assert rugged(promised, cost=drafted, found=("a",)) == 0


@pytest.mark.parametrize(("led", "settled"), [(199.0, 1), (201.0, 0)])
def test_such_an_effect_has_to_come_to_a_fourth_of_the_leaders_gain(led, settled):
    assert rugged(20.0, led=led) == settled


def test_by_windows_a_free_curve_gives_way_to_what_it_cannot_be_told_from():
    assert belief(OWN) == 0.0
    assert belief(OWN, by_windows=True) == -8.0
    assert not likelier(19.9, effect=OWN, by_windows=True)
    assert likelier(20.1, effect=OWN, by_windows=True)


def test_each_limit_has_a_case_at_its_edge():
    every = {field.name for each in (SearchLimits, SearchEffort) for field in fields(each)}
    assert every == EDGES.keys() | COUNTS.keys()


def test_arms_are_commoner_than_springs():
    assert belief(effect_named()) == 0.0
    assert belief(library()["gravity_load"]) - belief(library()["spring_load"]) == 5.0
