"""Pairs of recordings before and after a touch: what is made, what is sealed, and how an answer is judged."""

import json
from dataclasses import replace

import numpy as np
import pytest

from nxt_twin.blind.pairs.make import PairPlan, make_pair, make_pairs, plan_pairs
from nxt_twin.blind.pairs.reach import PairReach, reach_pairs, read_reach
from nxt_twin.blind.pairs.score import aims_of_pairs, as_lines, score_pairs
from nxt_twin.blind.pairs.touches import TOUCHES, stand_together
from nxt_twin.errors import CaseError
from nxt_twin.physics.library import library
from nxt_twin.recording.case import read_case


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """A pair with two changes on disk: cases, answers, and the case's name."""
    folder = tmp_path_factory.mktemp("pairs")
    plan = PairPlan("pair-0001", "bristle", 3, ("gravity", "supply"))
    assert list(make_pairs([plan], folder / "cases", folder / "answers")) == [("pair-0001", "")]
    return folder


def said(folder, *changes, verdict="changed", others=(), reached=None):
    """Judge an answer that names these, and `others` as pairs of a named change and what may stand in its place."""
    found = folder / "found"
    found.mkdir(exist_ok=True)
    alternatives = [{"instead_of": name, "id": other} for name, other in others]
    content = {
        "verdict": verdict,
        "changes": [{"of": one} for one in changes],
        "alternatives": alternatives,
    }
    (found / "pair-0001.json").write_text(json.dumps(content))
    (judged,) = score_pairs(folder / "cases", folder / "answers", found, reached)
    return judged


def test_a_plan_holds_what_was_asked_for_in_an_order_that_tells_nothing():
    plans = plan_pairs(5, ["bristle", "workshop"], none=4, one=4, two=3)
    assert sorted(len(plan.touches) for plan in plans) == [0] * 4 + [1] * 4 + [2] * 3
    assert {plan.family for plan in plans} == {"bristle", "workshop"}
    assert all(
        stand_together(*(TOUCHES[one] for one in plan.touches)) for plan in plans if len(plan.touches) > 1
    )
    assert plans == plan_pairs(5, ["bristle", "workshop"], none=4, one=4, two=3)


def test_both_sides_are_in_the_case_and_the_given_load_with_them(written):
    case = read_case(written / "cases" / "pair-0001")
    assert [one.name for one in case.before] == ["before-1.csv", "before-2.csv"]
    assert [one.name for one in case.recordings] == ["after-1.csv", "after-2.csv"]
    assert case.plant["effects"].keys() == {"gravity_load"}
    assert not any("battery_v" in one.columns for one in (*case.before, *case.recordings))


def test_a_supply_that_rose_drives_the_motor_faster():
    plans = {touches: PairPlan("one", "bristle", 11, touches) for touches in ((), ("supply",))}
    calm, touched = (make_pair(plan) for plan in plans.values())
    factor = touched.answer["changes"][0]["factor"]
    way = [np.abs(np.diff(pair.recordings[2].columns["a_tacho_deg"])).sum() for pair in (calm, touched)]
    assert calm.answer["changes"] == []
    assert np.sign(way[1] - way[0]) == np.sign(factor - 1.0)


def test_names_are_those_of_the_library():
    effects = {effect.id for effect in library().values()}
    assert {touch.effect for touch in TOUCHES.values()} - {None} <= effects
    assert all(touch.names for touch in TOUCHES.values())


def test_an_answer_has_to_name_everything_and_nothing_else(written):
    assert said(written, "gravity_torque_nm", "supply_v").exact
    assert said(written, "gravity_torque_nm", "supply_v", "inertia_kg_m2").exact  # an arm has inertia
    assert not said(written, "gravity_torque_nm").exact
    assert not said(written, "gravity_torque_nm", "supply_v", "coulomb_friction_nm").exact
    wrong = said(written, "gravity_torque_nm", "supply_v", verdict="unexplained")
    assert (wrong.exact, wrong.touched) == (False, ("gravity", "supply"))
    assert [aim.measured for aim in aims_of_pairs([wrong])] == [None, None, None, 0.0, 0.0]


def test_an_alternative_counts_beside_exact_and_never_as_exact(written):
    set_of_two = said(written, "gravity_torque_nm", "resistance_ohm", others=[("resistance_ohm", "supply_v")])
    assert (set_of_two.exact, set_of_two.holds, set_of_two.set_size) == (False, True, 3)
    elsewhere = said(
        written, "gravity_torque_nm", "resistance_ohm", others=[("gravity_torque_nm", "supply_v")]
    )
    assert not elsewhere.holds
    assert said(written, "gravity_torque_nm", "supply_v").holds
    exact, either = aims_of_pairs([set_of_two])[-2:]
    assert (exact.measured, either.measured) == (0.0, 1.0)


def test_the_true_changes_are_fitted_and_a_pair_that_hardly_shows_them_is_counted_apart(written):
    reached = written / "reached"
    (failed,) = reach_pairs([written / "cases" / "pair-0001"], written / "answers", reached)
    assert failed == ("pair-0001", "")
    reach = read_reach(reached / "pair-0001.json")
    assert reach.is_detectable
    assert set(reach.gain_nats) == {"gravity", "supply"}
    assert max(reach.true_rms) < 0.2 * max(reach.shared_rms)
    seen = said(written, "gravity_torque_nm", reached=reached)
    assert seen.detectable
    assert "not detectable" not in as_lines([seen])
    weak = PairReach({"gravity": 9.9, "supply": 99.0}, {}, (0.1, 0.2), (0.01, 0.01), 0.05)
    assert not weak.is_detectable
    assert not replace(weak, gain_nats={"gravity": 99.0}, tolerance=0.3).is_detectable
    assert replace(weak, gain_nats={"gravity": 10.1}).is_detectable
    unseen = replace(seen, detectable=False)
    assert "not detectable" in as_lines([unseen])
    assert [(aim.words, aim.cases) for aim in aims_of_pairs([unseen, seen])][-1] == (
        "two changes: both named, detectable",
        1,
    )


def test_an_answer_that_was_not_sealed_is_refused(written):
    said(written)
    sealed = written / "answers" / "pair-0001.json"
    text = sealed.read_text()
    sealed.write_text(text.replace("bristle", "another"))
    with pytest.raises(CaseError, match="sealed"):
        score_pairs(written / "cases", written / "answers", written / "found")
    sealed.write_text(text)
