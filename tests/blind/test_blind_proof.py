"""A proof in pieces: what is done is kept, and what is not done is told."""

from __future__ import annotations

import json
from functools import partial
from itertools import count

import pytest

from nxt_twin.blind.answer import seal
from nxt_twin.blind.fair import in_fair_order
from nxt_twin.blind.families.orders import Amounts, plan_orders
from nxt_twin.blind.families.table import FAMILIES
from nxt_twin.blind.proof import Proof
from nxt_twin.blind.ranges import SeedRange
from nxt_twin.blind.tables import proof_status, tables_of
from nxt_twin.fleet.workers.place import HERE

SMALL = SeedRange("small", (7,), Amounts(("stiction",), 1, 0, 0, 0), None, "of a test")
"""One stiction in three sizes and one clean motor, of one family."""


@pytest.fixture
def proof(tmp_path, monkeypatch):
    monkeypatch.setattr("nxt_twin.blind.prove.solve_one", answered({"verdict": "adequate"}))
    monkeypatch.setattr("nxt_twin.blind.prove.reach_one", answered(None))
    short = partial(plan_orders, duration_s=3.0)
    monkeypatch.setattr("nxt_twin.blind.ranges.plan_orders", short)
    return Proof(tmp_path, SMALL, (FAMILIES["bristle"],))


def answered(held):
    full = held and {**held, "effects": [], "refit": {}, "fit": {"improved": 1.0, "floor": 0.5}}

    def work(folder, target, *_):
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(json.dumps(full))
        return folder.name, ""

    return work


def run(proof, many=99):
    left = iter([True] * many)
    now_s = count(0.0, 40.0)
    return list(proof.run(HERE, lambda: next(now_s), lambda: next(left, False), peers=False))


def test_a_piece_does_the_first_cases_and_the_next_piece_goes_on(proof):
    first = run(proof, many=1)
    assert [name for name, _ in first] == [proof.cases[0].order.plan.name]
    assert proof_status(proof).splitlines()[:2] == [
        "small: 1 of 4 cases are finished",
        "3 cases are left: 6 min of processor time at 120.0 s a case",
    ]
    rest = run(proof)
    assert [name for name, _ in rest] == [case.order.plan.name for case in proof.cases[1:]]
    assert run(proof) == []
    assert tables_of(proof)["families"][1][1] == "4"


def test_effects_are_taken_out_last_and_once(proof, monkeypatch):
    seen = []

    def solved(folder, target, _, without):
        seen.append((folder.name, without))
        return answered({"verdict": "unexplained"})(folder, target)

    monkeypatch.setattr("nxt_twin.blind.prove.solve_one", solved)
    monkeypatch.setattr("nxt_twin.blind.proof.is_deleted", lambda case: case.kind == "single")
    run(proof)
    assert {without for _, without in seen} == {frozenset()}
    stictions = [case.order.plan.name for case in proof.undeleted()]
    assert len(stictions) == 3
    seen.clear()
    left = iter([True, False])
    assert len(list(proof.delete(HERE, lambda: 0.0, lambda: next(left)))) == 1
    assert len(list(proof.delete(HERE, lambda: 0.0, lambda: True))) == 2
    assert seen == [(name, frozenset({"stiction"})) for name in stictions]
    assert proof.undeleted() == []
    assert [len(ended.seconds) for ended in proof.finished()].count(4) == 3
    assert [deleted.verdict for deleted in proof.deletions()["stiction"]] == ["unexplained"] * 3


def test_an_effect_that_another_engine_takes_out_hides_no_engine(proof, monkeypatch):
    monkeypatch.setattr("nxt_twin.blind.proof.is_deleted", lambda case: case.kind == "single")
    monkeypatch.setattr("nxt_twin.blind.prove.engine_version", lambda: "first")
    run(proof)
    monkeypatch.setattr("nxt_twin.blind.prove.engine_version", lambda: "second")
    list(proof.delete(HERE, lambda: 0.0, lambda: True))
    assert sorted(ended.engine for ended in proof.finished()) == ["first", *["first and second"] * 3]
    assert "several engines" in proof_status(proof)


def test_a_case_that_fails_without_its_effect_is_not_tried_again(proof, monkeypatch):
    monkeypatch.setattr("nxt_twin.blind.proof.is_deleted", lambda case: case.kind == "single")
    run(proof)

    def broken(*_):
        raise ZeroDivisionError("no speed")

    monkeypatch.setattr("nxt_twin.blind.prove.solve_one", broken)
    told = list(proof.delete(HERE, lambda: 0.0, lambda: True))
    assert ["no speed" in why for _, why in told] == [True] * 3
    assert proof.undeleted() == []
    assert "no speed" in tables_of(proof)["no answer"][1][1]


def test_a_case_that_was_killed_half_way_is_done_again_and_keeps_its_files(proof):
    run(proof, many=1)
    case = proof.cases[0]
    root = proof.folder / "7"
    (root / "finished" / f"{case.order.plan.name}.json").unlink()
    made = (root / "answers" / f"{case.order.plan.name}.json").read_bytes()
    assert [name for name, _ in run(proof, many=1)] == [case.order.plan.name]
    assert (root / "answers" / f"{case.order.plan.name}.json").read_bytes() == made


def test_a_case_that_raises_is_told_and_counts_as_no_answer(proof, monkeypatch):
    def broken(*_):
        raise ZeroDivisionError("no speed")

    monkeypatch.setattr("nxt_twin.blind.prove.solve_one", broken)
    assert "no speed" in run(proof, many=1)[0][1]
    assert len(proof.finished()) == 1
    assert proof.judged()[0].verdict == "none"
    assert "no speed" in tables_of(proof)["no answer"][1][1]


def test_the_answer_lies_apart_from_the_case_which_holds_its_hash(proof):
    run(proof, many=1)
    name = proof.cases[0].order.plan.name
    folder = proof.folder / "7" / "cases" / name
    answer = proof.folder / "7" / "answers" / f"{name}.json"
    assert (folder / "answer.sha256").read_text().strip() == seal(answer.read_bytes())
    assert not any(b"effects" in file.read_bytes() for file in folder.iterdir())


def test_figures_of_several_engines_are_told(proof, monkeypatch):
    run(proof, many=1)
    monkeypatch.setattr("nxt_twin.blind.prove.engine_version", lambda: "another")
    run(proof)
    assert "several engines" in proof_status(proof)


def test_a_fair_order_spreads_each_stratum_over_the_whole():
    order = in_fair_order(["a"] * 6 + ["b"] * 2, lambda letter: letter)
    assert "".join(order) == "aabaaaba" or order.index("b") < 4
    assert [order[:4].count(letter) for letter in "ab"] == [3, 1]
