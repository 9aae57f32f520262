from __future__ import annotations

from pathlib import Path

import pytest

from nxt_twin.blind.by_family import (
    EVERY,
    as_text,
    best_limit,
    deletion_rows,
    family_rows,
    left_out_rows,
    reliability_rows,
    withheld,
)
from nxt_twin.blind.families.table import FAMILIES
from nxt_twin.blind.proof import Proof, taken_out
from nxt_twin.blind.ranges import RANGES
from nxt_twin.blind.reached import Reach
from nxt_twin.blind.verdict import Judged


def judged(family="workshop", kind="single", *, exact=True, verdict="explained", probability=0.99, ratio=1.0):
    hidden = {"clean": (), "single": ("cogging",), "pair": ("cogging", "stiction"), "unknown": ("crank",)}[
        kind
    ]
    named = ("cogging",) if verdict == "explained" else ()
    return Judged(
        name="case",
        kind=kind,
        hidden=hidden,
        sizes=("large",) * len(hidden),
        effect_rms_deg=10.0,
        verdict=verdict,
        named=named,
        considered=frozenset(named),
        exact=exact,
        holds=exact,
        misnamed=kind == "unknown" and verdict == "explained",
        parameter_error={},
        parameter_error_own={},
        covered={},
        fit_ratio=1.0,
        improved=ratio,
        reach=Reach(100.0, 50.0, 1.0),
        family=family,
        probability=dict.fromkeys(named, probability),
    )


def row_of(rows, name):
    return dict(zip(rows[0], next(row for row in rows if row[0] == name), strict=True))


def test_each_family_is_counted_for_itself_and_what_falls_short_is_marked():
    cases = [judged("workshop"), judged("mujoco", exact=False), judged("mujoco", "clean", exact=False)]
    rows = family_rows(cases)
    assert row_of(rows, "workshop")["exact"] == "1.00"
    assert row_of(rows, "mujoco")["exact"] == "0.00 !"
    assert row_of(rows, "mujoco")["clean wrong"] == "1.00 !"
    assert row_of(rows, EVERY)["exact"] == "0.50 !"
    assert row_of(rows, "workshop")["pairs"] == "-"


def test_the_error_is_held_against_that_of_the_true_structure():
    rows = family_rows([judged(ratio=ratio) for ratio in (1.0, 1.0, 1.0, 5.0)])
    assert row_of(rows, EVERY)["error ratio"] == "1.00"
    assert row_of(rows, EVERY)["90 %"] == "3.80 !"


def test_a_name_below_the_limit_is_withheld_which_is_right_for_unknown_physics_only():
    unknown = judged(kind="unknown", exact=False, probability=0.6)
    assert withheld(unknown, 0.7).exact
    assert not withheld(unknown, 0.7).misnamed
    assert not withheld(judged(probability=0.6), 0.7).exact
    assert withheld(judged(probability=0.8), 0.7).exact


def test_the_limit_is_set_on_the_other_families():
    unsure = [judged("mujoco", "unknown", exact=False, probability=0.75) for _ in range(3)]
    sure = [judged("mujoco", probability=0.97) for _ in range(3)]
    assert best_limit([*unsure, *sure]) > 0.75
    own = [judged("stiff", probability=0.6)]
    rows = left_out_rows([*unsure, *sure, *own])
    assert float(row_of(rows, "stiff")["limit"]) > 0.75
    assert row_of(rows, "stiff")["exact"] == "0.00 !"


def test_reliability_holds_the_probability_against_the_hits():
    hit, miss = judged(probability=0.97), judged(kind="unknown", exact=False, probability=0.96)
    row = row_of(reliability_rows([hit, miss]), "0.95 to 0.99")
    assert (row["names"], row["hit rate"]) == ("2", "0.50")


def test_deletions_are_counted_by_verdict():
    rows = deletion_rows({"cogging": ["unexplained", "explained"], "stiction": ["unexplained"]})
    assert row_of(rows, "cogging")["another name"] == "1"
    assert row_of(rows, EVERY)["unexplained"] == "2"
    assert as_text(rows).splitlines()[0].startswith("taken out")


def test_the_scored_range_holds_what_it_must_and_no_development_seed():
    scored = RANGES["scored"]
    assert min(scored.seeds) >= 5000
    orders = [order for each in scored.orders(tuple(FAMILIES.values())).values() for order in each]
    known = [order for order in orders if set(order.plan.effects) <= set(FAMILIES[order.family].known)]
    counts = [sum(len(order.plan.effects) == number for order in known) for number in range(4)]
    assert counts[0] >= 300
    assert counts[1] >= 500
    assert counts[2] >= 100
    assert counts[3] >= 50
    strangers = [order.plan.effects[0] for order in orders if order not in known]
    assert len(strangers) >= 100
    assert len(set(strangers)) >= 10


def test_a_sample_takes_the_first_of_each_family_from_development_seeds():
    sample = RANGES["sample"]
    orders = [order for each in sample.orders(tuple(FAMILIES.values())).values() for order in each]
    assert all(sum(order.family == name for order in orders) == sample.most for name in FAMILIES)
    assert max(sample.seeds) < 1000


@pytest.fixture
def empty(tmp_path: Path) -> Proof:
    return Proof(tmp_path, RANGES["sample"], tuple(FAMILIES.values()))


def test_a_proof_names_its_stages_before_they_run(empty):
    title, total, _ = next(empty.run(1))
    assert title == "making 901"
    assert total == RANGES["sample"].most * len(FAMILIES)


def test_what_holds_an_effects_physics_is_taken_out_with_it():
    assert taken_out("gravity_load") == {"gravity_load", "hanging_payload"}
    assert taken_out("cogging") == {"cogging"}


def test_of_limits_that_are_worth_as_much_the_least_is_taken():
    assert best_limit([judged("mujoco", probability=1.0)]) == 0.0
