from __future__ import annotations

from dataclasses import replace

import pytest

from nxt_twin.blind.by_family import (
    EVERY,
    best_limit,
    family_rows,
    left_out_rows,
    withheld,
)
from nxt_twin.blind.families.table import FAMILIES
from nxt_twin.blind.prove import taken_out
from nxt_twin.blind.ranges import RANGES
from nxt_twin.blind.reached import Reach
from nxt_twin.blind.tables import as_text
from nxt_twin.blind.told import (
    Deleted,
    calibration_rows,
    chance_of_something_else,
    confusion_rows,
    deletion_rows,
    floor_rows,
    reliability_rows,
    unknown_rows,
)
from nxt_twin.blind.verdict import Judged
from nxt_twin.diagnose.telling.calibration import told_probability


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
        reach=Reach(100.0, 50.0, 1.0, {2.0: 1.0}),
        family=family,
        probability=dict.fromkeys(named, probability),
        floors={2.0: 0.9},
    )


def row_of(rows, name):
    return dict(zip(rows[0], next(row for row in rows if row[0] == name), strict=True))


EXACT, PAIRS, CLEAN = "single, detectable: exact", "pairs: exact", "clean: called wrong"


def test_each_family_is_counted_for_itself_and_what_falls_short_is_marked():
    cases = [judged("workshop"), judged("mujoco", exact=False), judged("mujoco", "clean", exact=False)]
    rows = family_rows(cases)
    assert row_of(rows, EXACT)["workshop"] == "1.00 of 1"
    assert row_of(rows, EXACT)["mujoco"] == "0.00 of 1 !"
    assert row_of(rows, CLEAN)["mujoco"] == "1.00 of 1 !"
    assert row_of(rows, EXACT)[EVERY] == "0.50 of 2 !"
    assert row_of(rows, PAIRS)["workshop"] == "-"


def test_pairs_are_counted_all_and_those_apart_that_show_both():
    gains = {"cogging": 50.0, "stiction": 11.0}
    shown = replace(judged(kind="pair"), reach=Reach(100.0, 50.0, 1.0, {}, gains))
    faint = replace(shown, exact=False, reach=Reach(100.0, 50.0, 1.0, {}, {**gains, "stiction": 9.0}))
    unknown = judged(kind="pair", exact=False)
    rows = family_rows([shown, faint, unknown])
    assert row_of(rows, PAIRS)[EVERY] == "0.33 of 3 !"
    assert row_of(rows, "pairs that show both: exact")[EVERY] == "1.00 of 1"


def test_the_error_is_held_against_that_of_the_true_structure():
    rows = family_rows([judged(ratio=ratio) for ratio in (1.0, 1.0, 1.0, 5.0)])
    assert row_of(rows, "error over the true structure's: median")[EVERY] == "1.00 of 4"
    assert row_of(rows, "error over the true structure's: 90 %")[EVERY] == "3.80 of 4 !"


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
    assert float(row_of(rows, "least probability of a name")["stiff"]) > 0.75
    assert row_of(rows, EXACT)["stiff"] == "0.00 of 1 !"


def test_reliability_holds_the_probability_against_the_hits():
    hit, miss = judged(probability=0.97), judged(kind="unknown", exact=False, probability=0.96)
    row = row_of(reliability_rows([hit, miss]), "0.91 to 1")
    assert (row["names"], row["hit rate"]) == ("2", "0.50")


def test_the_chance_of_something_else_is_learnt_on_the_other_families():
    elsewhere = [judged("mujoco", probability=0.92)] * 17
    wrong = judged("stiff", "unknown", exact=False, probability=0.92)
    row = row_of(calibration_rows([*elsewhere, wrong]), "stiff")
    assert (row["names elsewhere"], row["names here"]) == ("17", "1")
    assert (row["chance of something else there"], row["mean told"]) == ("0.053", "0.95")
    assert row["hit rate"].startswith("0/1")
    assert chance_of_something_else([(1.0, True)] * 17 + [(1.0, False)]) == pytest.approx(0.1)
    assert chance_of_something_else([(0.5, True), (0.5, False)] * 9) == pytest.approx(0.05)


def test_a_told_probability_leaves_room_for_what_was_not_weighed():
    assert told_probability(1.0) == pytest.approx(0.92)
    assert told_probability(0.6) == pytest.approx(0.552)


def test_deletions_are_counted_by_verdict():
    refused, named = Deleted("unexplained", ()), Deleted("explained", ("stiction", "backlash"))
    rows = deletion_rows({"cogging": [refused, named, named], "stiction": [refused]})
    assert rows[1] == ("cogging", "3", "1", "2", "0", "stiction + backlash 2")
    assert rows[-1] == ("all", "4", "2", "2", "0", "")
    assert as_text(rows).splitlines()[0].startswith("taken out")


@pytest.mark.parametrize("own", ["scored", "release"])
def test_the_scored_range_holds_what_it_must_and_no_seed_of_another(own):
    scored = RANGES[own]
    assert not set(scored.seeds) & {seed for name, one in RANGES.items() if name != own for seed in one.seeds}
    assert min(scored.seeds) >= 5000
    orders = [case.order for case in scored.cases(tuple(FAMILIES.values()))]
    known = [order for order in orders if set(order.plan.effects) <= set(FAMILIES[order.family].known)]
    counts = [sum(len(order.plan.effects) == number for order in known) for number in range(4)]
    assert counts[0] >= 300
    assert counts[1] >= 500
    assert counts[2] >= 100
    assert counts[3] >= 50
    strangers = [order.plan.effects[0] for order in orders if order not in known]
    assert len(strangers) >= 100
    assert len(set(strangers)) >= 10


def test_the_range_of_silence_holds_clean_motors_and_unknown_effects_of_a_seed_of_its_own():
    silence = RANGES["silence"]
    assert min(silence.seeds) >= 5000
    assert not set(silence.seeds) & set(RANGES["scored"].seeds)
    orders = [case.order for case in silence.cases(tuple(FAMILIES.values()))]
    clean = [order for order in orders if not order.plan.effects]
    strangers = [o for o in orders if set(o.plan.effects) & set(FAMILIES[o.family].unknown)]
    assert (len(clean), len(strangers), len(orders)) == (100, 100, 200)


def test_the_range_fifth_is_half_a_scored_one_of_a_seed_of_its_own():
    whole, half = RANGES["release"], RANGES["fifth"]
    assert half.amounts == whole.amounts
    assert len(half.seeds) == 1
    assert not set(half.seeds) & {
        seed for name, one in RANGES.items() if name != "fifth" for seed in one.seeds
    }
    assert min(half.seeds) >= 5000


@pytest.mark.parametrize(
    ("own", "singles", "pairs"),
    [
        ("second", 60, 24),
        ("third", 60, 24),
        ("fourth", 60, 24),
        ("sixth", 96, 24),
        ("seventh", 200, 48),
        ("eighth", 200, 48),
    ],
)
def test_a_small_scored_range_holds_a_share_of_every_kind_and_a_seed_of_its_own(own, singles, pairs):
    found = RANGES[own]
    others = [seed for name, one in RANGES.items() if name != own for seed in one.seeds]
    assert min(found.seeds) >= 5000
    assert not set(found.seeds) & set(others)
    orders = [case.order for case in found.cases(tuple(FAMILIES.values()))]
    known = [order for order in orders if set(order.plan.effects) <= set(FAMILIES[order.family].known)]
    counts = [sum(len(order.plan.effects) == number for order in known) for number in range(4)]
    assert counts == [100, singles, pairs, 0]
    assert len(orders) - len(known) == 100
    alone = [order for order in known if len(order.plan.effects) == 1]
    each = [sum(order.family == name for order in alone) for name in FAMILIES]
    assert max(each) - min(each) <= 4  # one family cannot express every effect


@pytest.mark.parametrize(
    ("name", "seeds"),
    [
        ("ninth", (5013, 5014)),
        ("tenth", (5015, 5016)),
        ("eleventh", (5017, 5018)),
        ("twelfth", (5019, 5020)),
        ("thirteenth", (5021, 5022)),
        ("fourteenth", (5023, 5024)),
        ("fifteenth", (5025, 5026)),
    ],
)
def test_a_range_is_as_large_as_a_scored_range_has_to_be(name, seeds):
    found = RANGES[name]
    assert found.seeds == seeds
    assert not {seed for other, one in RANGES.items() if other != name for seed in one.seeds} & set(seeds)
    orders = [case.order for case in found.cases(tuple(FAMILIES.values()))]
    strange = [set(o.plan.effects) & set(FAMILIES[o.family].unknown) for o in orders]
    counts = [
        sum(len(o.plan.effects) == n for o, s in zip(orders, strange, strict=True) if not s) for n in range(4)
    ]
    kinds = {name for own in strange for name in own}
    assert counts == [304, 504, 104, 56]
    assert sum(map(bool, strange)) == 104
    assert len(kinds) >= 10


def test_a_sample_is_a_fair_beginning_of_development_seeds():
    sample = RANGES["sample"]
    cases = sample.cases(tuple(FAMILIES.values()))
    assert len(cases) == sample.most
    numbers = [sum(case.order.family == name for case in cases) for name in FAMILIES]
    assert max(numbers) - min(numbers) <= 3
    assert {len(case.order.plan.effects) for case in cases} == {0, 1, 2, 3}
    assert max(sample.seeds) < 1000


def test_the_range_for_development_mixes_kinds_as_small_scored_ranges_do():
    found = RANGES["development"]
    assert max(found.seeds) < 1000
    orders = [case.order for case in found.cases(tuple(FAMILIES.values()))]
    known = [order for order in orders if set(order.plan.effects) <= set(FAMILIES[order.family].known)]
    assert [sum(len(order.plan.effects) == number for order in known) for number in range(4)] == [
        24,
        40,
        24,
        0,
    ]
    assert len(orders) - len(known) == 24


@pytest.mark.parametrize("beginning", [0.1, 0.25, 0.5])
def test_each_beginning_of_the_scored_range_holds_every_kind_in_proportion(beginning):
    cases = RANGES["scored"].cases(tuple(FAMILIES.values()))
    done = cases[: int(beginning * len(cases))]

    def share(of, family, number):
        return sum(case.order.family == family and len(case.order.plan.effects) == number for case in of)

    for family in FAMILIES:
        for number in range(4):
            assert abs(share(done, family, number) - beginning * share(cases, family, number)) <= 3.5


def test_what_holds_an_effects_physics_is_taken_out_with_it():
    assert taken_out("gravity_load") == {"gravity_load", "hanging_payload"}
    assert taken_out("cogging") == {"cogging"}


def test_of_limits_that_are_worth_as_much_the_least_is_taken():
    assert best_limit([judged("mujoco", probability=1.0)]) == 0.0


def test_confusions_tell_what_was_named_in_an_effects_place():
    wrong = replace(judged(exact=False), named=("stiction", "backlash"))
    row = row_of(confusion_rows([judged(), wrong, judged("mujoco", "clean")]), "cogging")
    assert (row["cases"], row["exact"], row["named otherwise"]) == ("2", "1", "stiction + backlash 1")


def test_physics_of_nobodys_library_is_counted_by_its_kind():
    refused = judged(kind="unknown", verdict="unexplained")
    row = row_of(unknown_rows([refused, judged(kind="unknown", exact=False)]), "crank")
    assert (row["cases"], row["refused"], row["misnamed"], row["named"]) == ("2", "1", "1", "cogging 1")


def test_floors_are_held_against_the_true_structure_where_the_library_holds_it():
    low = replace(judged("stiff"), floors={2.0: 0.5})
    met = replace(judged(), floors={2.0: 0.9}, reached={2.0: 1.0})
    rows = floor_rows([met, low, judged(kind="unknown")])
    row = row_of(rows, EVERY)
    assert (row["windows"], row["cases"], row["median"], row["within 0.8 to 1.25"]) == (
        "2 s",
        "2",
        "0.70",
        "0.50",
    )
    assert row["where named exactly"] == "0.50 of 2"
    assert row["is the error reached"] == "0.00"


def test_a_floor_is_held_against_the_best_known_fit_of_the_true_structure():
    nearer = replace(judged(), floors={2.0: 0.4}, reached={2.0: 0.4})
    other = replace(nearer, named=("stiction",))
    assert row_of(floor_rows([nearer]), EVERY)["median"] == "1.00"
    assert row_of(floor_rows([other]), EVERY)["median"] != "1.00"


def test_floors_of_models_that_lack_an_effect_are_told_apart():
    right = judged()
    wrong = replace(judged(exact=False), named=("stiction",), floors={2.0: 9.0})
    row = row_of(floor_rows([right, wrong]), EVERY)
    assert (row["within 0.8 to 1.25"], row["where named exactly"]) == ("0.50", "1.00 of 1")
