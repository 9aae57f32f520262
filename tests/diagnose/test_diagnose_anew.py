"""Ways that a search has seen and not gone: begun from anew where the search ends without an answer."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from diagnose_anew import explanation, searched_from
from diagnose_limits import effect_named, structure
from diagnose_records import FOUND, QUIET

from nxt_twin.diagnose import inquiry
from nxt_twin.diagnose.search import explain as explaining
from nxt_twin.diagnose.search import untaken as ways
from nxt_twin.diagnose.search.untaken import Untaken, leads_on
from nxt_twin.diagnose.search.weight import Weight

NAMED = replace(FOUND, nearer=0.3, surprise=0.5, remaining=9.0)
LACKING = replace(QUIET, left_nats=100.0, torque_before=0.1, torque_after=0.1)


@pytest.mark.parametrize(
    ("gain", "check", "ratio", "leads"),
    [
        (8.1, 2.1, 1.5, True),
        (7.9, 2.1, 1.5, False),
        (8.1, 1.9, 1.5, False),
        (-99.0, -99.0, 0.49, True),
        (-99.0, -99.0, 0.51, False),
    ],
)
def test_a_way_leads_on_by_likelihood_whatever_free_runs_say_or_by_much_nearer_ones(
    gain, check, ratio, leads
):
    assert leads_on(Weight(gain, check, ratio, runs_worse=True)) is leads


def test_ways_beside_an_answer_come_nearest_first_without_those_that_it_went(monkeypatch):
    errors = {"a": 0.4, "b": 0.2, "c": 0.3, "d": 0.1}
    weights = {"d": Weight(-1.0, 0.0, 0.9, runs_worse=True)}
    nearer = Weight(-1.0, 0.0, 0.4, runs_worse=True)
    monkeypatch.setattr(ways, "weigh", lambda _, s: weights.get(max(s.plant.active), nearer))
    untaken = Untaken()
    untaken.note(structure(), [(effect_named(n), structure(n, error=e)) for n, e in errors.items()])
    found = untaken.beside(structure("b", "z"))
    assert [sorted(one.plant.active) for one in found] == [["c"], ["a"]]


def test_of_the_ways_with_one_set_of_effects_the_last_is_kept(monkeypatch):
    monkeypatch.setattr(ways, "weigh", lambda *_: Weight(9.0, 9.0, 1.0, runs_worse=False))
    untaken, later = Untaken(), structure("a", cost=-5.0)
    untaken.note(structure(), [(effect_named("a"), structure("a"))])
    untaken.note(structure("b"), [(effect_named("a"), later)])
    assert untaken.beside(structure()) == (later,)


@pytest.mark.parametrize(
    ("total", "led", "times"), [(8.1, True, 2), (7.9, True, 1), (8.1, False, 1), (7.9, False, 1)]
)
def test_a_way_is_gone_further_only_where_its_next_step_is_likelier_than_what_was_found(
    monkeypatch, total, led, times
):
    begin, grown = structure("a"), []

    class Searching:
        def __init__(self, _, baseline, unnamed):
            self.baseline, self.unnamed_before = baseline, unnamed

        def grown(self, best, _, steps=9):
            grown.append(steps)
            return structure(*best.plant.active, "b") if led else best, ()

    monkeypatch.setattr(explaining, "_Search", Searching)
    monkeypatch.setattr(explaining, "weigh", lambda *_: Weight(total, 0.0, 1.0, runs_worse=False))
    monkeypatch.setattr(explaining, "_exchanged", lambda _, __, grown, ___: grown[0])
    end = explaining.explain_anew(None, explanation(), begin, lambda _: None)
    assert grown == [1, 9][:times]
    assert (end is None) is (total < 8.0)


def test_each_way_has_to_beat_what_the_ones_before_led_to(monkeypatch):
    found, began, _ = searched_from(monkeypatch, [("x",), ("y",)])
    assert found == [["x"], ["y"]]
    assert [sorted(beaten.plant.active) for _, _, beaten in began] == [["z"], ["x"]]


def test_a_way_that_leads_to_nothing_likelier_is_no_answer(monkeypatch):
    assert searched_from(monkeypatch, [None, ("y",)])[0] == [["y"]]


def test_a_way_that_leads_back_is_no_answer(monkeypatch):
    assert searched_from(monkeypatch, [("z",)])[0] == []


@pytest.mark.parametrize(("costs", "begun"), [((0.0, -1.0), -1.0), ((0.0, 1.0), 0.0)])
def test_a_way_begins_where_a_small_unknown_torque_leads_it_if_that_is_likelier(monkeypatch, costs, begun):
    _, began, _ = searched_from(monkeypatch, [None], costs)
    assert began[0][1] == begun


class Judged(SimpleNamespace):
    """As much of the evidence as the choice between two answers needs."""


def judged(record, error):
    errors = SimpleNamespace(rms=[error], seconds=(2.0,))
    return Judged(
        record=record, final_errors=errors, problem=SimpleNamespace(window_s=2.0), explanation=explanation()
    )


@pytest.mark.parametrize(
    ("before", "errors", "chosen"),
    [
        (LACKING, (4.9,), 4.9),
        (LACKING, (5.1,), 10.0),
        (replace(NAMED, moved=9.0), (6.4,), 6.4),
        (replace(NAMED, moved=9.0), (6.6,), 10.0),
        (LACKING, (4.9, 1.0), 4.9),
        (LACKING, (5.1, 1.0), 1.0),
        (replace(QUIET, remaining=3.01), (4.9,), 4.9),
    ],
)
def test_the_first_answer_of_another_way_that_brings_unseen_readings_much_nearer_is_taken(
    monkeypatch, before, errors, chosen
):
    ends = [judged(NAMED, error) for error in errors]
    monkeypatch.setattr(inquiry, "searched_anew", lambda *_: iter(range(len(ends))))
    monkeypatch.setattr(inquiry, "_judged", lambda _, __, found, ___: ends[found])
    monkeypatch.setattr(inquiry, "nearest_horizon", lambda *_: 0)
    monkeypatch.setattr(inquiry, "_with_sizes", lambda one: one)
    told: list[str] = []
    found = inquiry._begun_anew(None, judged(before, 10.0), None, told.append)
    assert found.final_errors.rms == [chosen]
    assert len(told) == 1


@pytest.mark.parametrize("record", [NAMED, replace(QUIET, remaining=3.0)])
def test_an_answer_is_left_as_it_is(monkeypatch, record):
    monkeypatch.setattr(inquiry, "searched_anew", lambda *_: pytest.fail("searched anew"))
    monkeypatch.setattr(inquiry, "_with_sizes", lambda one: one)
    before = judged(record, 10.0)
    assert inquiry._begun_anew(None, before, None, lambda _: None) is before
