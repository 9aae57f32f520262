from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from nxt_twin.blind.case import SEAL_FILE
from nxt_twin.blind.families.family import Order
from nxt_twin.blind.families.habits import Habits, draw_length_s, polls_s
from nxt_twin.blind.families.numbers import Chain
from nxt_twin.blind.families.orders import Amounts, families_of, make_orders, plan_orders
from nxt_twin.blind.families.table import BRISTLE, FAMILIES
from nxt_twin.blind.sets import CasePlan, plan_set
from nxt_twin.errors import CaseError
from nxt_twin.recording.case import read_case
from nxt_twin.recording.files import read_sidecar

HABITS = Habits(3, 20.0, 0.0, 50.0, 0.1, 0.0, 0.1, 1.0, 10)
FOREIGN = [name for name in FAMILIES if name != BRISTLE]
STRONG = ("stiction", "backlash", "gravity_load", "command_delay")
CONTRACT = set(FAMILIES[BRISTLE].known) | {"hanging_payload", "sample_hold"}


@cache
def case_of(family, effects=(), size="large", seed=6, duration_s=2.0):
    plan = CasePlan("case", seed, effects, size)
    return FAMILIES[family].make(Order(family, plan, "usb", duration_s))


def begins(case) -> str:
    return case.answer["recordings"]["r1.csv"]["begins"]


def begun(kind, family="workshop", effects=()):
    """The first case of a family whose recordings begin so."""
    return next(case for seed in range(40) if begins(case := case_of(family, effects, seed=seed)) == kind)


def moved_early_deg(case) -> list[float]:
    """How far the true hub turns in the first 60 ms of each recording."""
    return [
        abs(float(np.interp(0.06, one.time_s, case.answer["recordings"][one.name]["hub_deg"])) - hub[0])
        for one in case.recordings
        if (hub := case.answer["recordings"][one.name]["hub_deg"])
    ]


def same(one, other) -> bool:
    return all(
        np.array_equal(a.columns[name], b.columns[name], equal_nan=True)
        for a, b in zip(one.recordings, other.recordings, strict=True)
        for name in a.columns
    )


@pytest.mark.parametrize("family", FOREIGN)
def test_a_seed_makes_the_same_case_again_and_another_seed_another(family):
    first, again, other = (
        case_of.__wrapped__(family, ("stiction",), seed=seed, duration_s=1.0) for seed in (5, 5, 17)
    )
    assert first.answer == again.answer
    assert same(first, again)
    assert first.answer["base"] != other.answer["base"]


@pytest.mark.parametrize("family", FOREIGN)
def test_effects_of_a_foreign_family_are_the_contracts_or_said_to_be_in_nobodys_library(family):
    assert set(FAMILIES[family].known) <= CONTRACT
    assert set(FAMILIES[family].unknown).isdisjoint(CONTRACT)
    assert len(FAMILIES[family].unknown) >= 3


def test_ten_kinds_of_unknown_physics_and_no_two_of_a_name():
    unknown = [name for family in FAMILIES.values() for name in family.unknown]
    assert len(set(unknown)) == len(unknown)
    assert len(unknown) >= 10


@pytest.mark.slow_variants
@pytest.mark.parametrize(
    ("family", "effect"),
    [
        pytest.param(
            family, effect, marks=pytest.mark.slow if family == "mujoco" and effect in STRONG[:2] else ()
        )
        for family in FOREIGN
        for effect in STRONG
    ],
)
def test_a_large_effect_moves_the_reading_and_the_answer_is_in_the_contracts_terms(family, effect):
    if effect not in FAMILIES[family].known:
        pytest.skip("left out of this family")
    answer = case_of(family, (effect,), duration_s=1.2).answer
    assert answer["family"] == family
    assert answer["effect_rms_deg"] > 0.5
    home = case_of(BRISTLE, (effect,), duration_s=1.2).answer["effects"][0]
    assert set(home["params"]) - {"from_s"} <= set(answer["effects"][0]["params"])


@pytest.mark.parametrize("family", FOREIGN)
def test_a_clean_case_shows_the_true_angle_below_one_step_of_its_encoder(family):
    case = case_of(family)
    assert case.answer["effects"] == []
    for recording in case.recordings:
        true_deg = np.array(case.answer["recordings"][recording.name]["hub_deg"])
        below_deg = true_deg - recording.columns["a_tacho_deg"]
        assert below_deg.min() >= -1e-3
        assert below_deg.max() <= case.answer["step_deg"] + 1e-3
        assert np.all(np.diff(recording.time_s) > 0.0)
        assert np.ptp(true_deg) > 1.0


@pytest.mark.parametrize("family", FOREIGN)
def test_the_baseline_is_off_by_a_fifth_at_most(family):
    answer = case_of(family).answer
    off = [abs(answer["baseline"][key] / value - 1.0) for key, value in answer["base"].items()]
    assert 0.02 < max(off) < 0.2001


def test_a_logger_that_writes_the_last_command_puts_it_a_row_late():
    late = next(
        case
        for seed in range(45, 135)  # those before have none
        if (case := case_of("workshop", ("command_delay",), seed=seed)).answer["effects"][0]["params"][
            "delay_s"
        ]
        < 0.0
        and case.answer["rate_hz"] < 60.0
        and begins(case) == "off"
    )
    recording = late.recordings[0]
    moved = np.flatnonzero(np.abs(np.diff(recording.columns["a_tacho_deg"])) > 0.0)[0] + 1
    commanded = np.flatnonzero(recording.columns["a_power_pct"])[0]
    assert moved <= commanded


def test_rows_that_chance_stamps_late_stay_in_order_and_are_as_late_for_commands():
    chain = Chain(lag_span_s=0.03, lag_phase=0.4, lag_by_chance=1.0)
    polls = np.arange(500) * 0.02
    late_s = chain.lag_s(polls)
    assert np.diff(polls + late_s).min() > 0.0
    assert late_s.min() >= 0.0
    assert late_s.max() == pytest.approx(0.03, rel=0.05)
    assert np.corrcoef(np.diff(late_s)[1:], np.diff(late_s)[:-1])[0, 1] < -0.2
    np.testing.assert_array_equal(chain.lag_s(polls), late_s)
    assert not np.array_equal(chain.lag_s(polls[:400])[:100], late_s[:100])


def test_some_skewed_clocks_are_late_by_chance_and_some_wander():
    turns = []
    for seed in range(12):
        late = case_of("workshop", ("clock_skew",), seed=seed).recordings[0].time_s
        apart = np.diff(late) - np.median(np.diff(late))
        turns.append(float(np.corrcoef(apart[1:], apart[:-1])[0, 1]))
    assert min(turns) < -0.2
    assert max(turns) > -0.08


def test_a_recording_begins_with_the_motor_off_or_in_the_midst_of_a_program_or_of_a_motion():
    off, driven, cut = (begun(kind) for kind in ("off", "driven", "cut"))
    assert all(not one.columns["a_power_pct"][one.time_s < 0.2].any() for one in off.recordings)
    assert max(moved_early_deg(off)) < 0.1
    assert any(one.columns["a_power_pct"][0] != 0.0 for one in driven.recordings)
    assert max(moved_early_deg(cut)) > 5.0
    for case in (off, driven, cut):
        assert all(one.time_s[0] == 0.0 for one in case.recordings)
        assert all(np.isfinite(one.columns["battery_v"][0]) for one in case.recordings)


@pytest.mark.slow_variants
@pytest.mark.parametrize(
    "family", [pytest.param(one, marks=pytest.mark.slow) if one == "mujoco" else one for one in FOREIGN]
)
def test_a_cut_recording_is_the_end_of_a_longer_motion_of_its_motor(family):
    case = begun("cut", family)
    reading_deg = [float(one.columns["a_tacho_deg"][0]) for one in case.recordings]
    true_deg = [case.answer["recordings"][one.name]["hub_deg"][0] for one in case.recordings]
    assert np.abs(np.subtract(true_deg, reading_deg)).max() <= case.answer["step_deg"] + 1e-3
    assert all(1.0 < one.time_s[-1] <= 2.1 for one in case.recordings)


def test_some_hosts_make_recordings_of_unlike_lengths():
    lengths_s = [
        draw_length_s(rng, replace(HABITS, uneven=uneven))
        for uneven in (0.0, 0.25)
        for rng in map(np.random.default_rng, range(20))
    ]
    assert set(lengths_s[:20]) == {20.0}
    assert 15.0 < min(lengths_s[20:]) < 16.5 < 18.5 < max(lengths_s[20:]) < 20.0


@pytest.mark.parametrize("before_s", [0.0, 1.7])
def test_polls_before_a_recording_end_with_one_at_zero(before_s):
    read_s = polls_s(np.random.default_rng(3), HABITS, 2.0, before_s)
    assert np.all(np.diff(read_s) > 0.0)
    assert 0.0 in read_s
    assert abs(read_s[0] + before_s) < 0.1
    assert 1.8 < read_s[-1] <= 2.0


def test_families_are_planned_together_and_that_at_home_stays_as_it_was():
    orders = plan_orders(
        families_of(("bristle", "workshop")), 7, Amounts(clean=2, pairs=2, triples=1, unknown=1)
    )
    home = [order.plan for order in orders if order.family == BRISTLE]
    assert home == list(plan_set(7, clean=2, pairs=2, triples=1, unknown=1))
    assert len({order.plan.name for order in orders}) == len(orders)


def test_a_family_or_an_effect_that_is_none_is_refused():
    with pytest.raises(CaseError, match=r"no family 'attic'.*workshop"):
        families_of(("attic",))
    with pytest.raises(CaseError, match="no effect 'gremlins'"):
        plan_orders(families_of(("workshop",)), 1, Amounts(("gremlins",)))


def test_cases_are_written_sealed_with_the_encoders_step_beside_and_made_once(tmp_path):
    amounts = Amounts(("cogging",), clean=1, pairs=0, triples=0, unknown=0)
    orders = plan_orders(families_of(("workshop",)), 2, amounts, duration_s=5.0)
    cases, answers = tmp_path / "cases", tmp_path / "answers"
    assert sorted(make_orders(orders, cases, answers)) == sorted((order.plan.name, "") for order in orders)
    assert list(make_orders(orders, cases, answers)) == []
    for order in orders:
        folder = cases / order.plan.name
        assert (folder / SEAL_FILE).exists()
        answer = json.loads((answers / f"{order.plan.name}.json").read_text())
        assert read_case(folder).recordings
        assert read_sidecar(folder / "r1.csv").get("tacho_step_deg", 1.0) == answer["step_deg"]
