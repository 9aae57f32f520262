"""Pairs of recordings before and after a touch: what is made, what is sealed, and how an answer is judged."""

import json

import numpy as np
import pytest

from nxt_twin.blind.pairs.make import PairPlan, make_pair, make_pairs, plan_pairs
from nxt_twin.blind.pairs.score import aims_of_pairs, score_pairs
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


def said(folder, *changes, verdict="changed"):
    """Judge an answer that names these."""
    found = folder / "found"
    found.mkdir(exist_ok=True)
    content = {"verdict": verdict, "changes": [{"of": one} for one in changes]}
    (found / "pair-0001.json").write_text(json.dumps(content))
    (judged,) = score_pairs(folder / "cases", folder / "answers", found)
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
    assert [aim.measured for aim in aims_of_pairs([wrong])] == [None, None, 0.0]


def test_an_answer_that_was_not_sealed_is_refused(written):
    said(written)
    sealed = written / "answers" / "pair-0001.json"
    text = sealed.read_text()
    sealed.write_text(text.replace("bristle", "another"))
    with pytest.raises(CaseError, match="sealed"):
        score_pairs(written / "cases", written / "answers", written / "found")
    sealed.write_text(text)
