"""What a search refused: looked at again where something is missing, and told where it only helps."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest
from diagnose_records import FOUND, QUIET

from nxt_twin.blind.case import NOMINAL
from nxt_twin.diagnose import inquiry
from nxt_twin.diagnose.search import helping as helpers
from nxt_twin.diagnose.search.explain import Explanation
from nxt_twin.diagnose.search.helping import helping
from nxt_twin.diagnose.search.weight import Weight
from nxt_twin.physics.plant import plant_from_config

PLAIN = plant_from_config({"kind": "dc_motor", **NOMINAL}, "power_pct")


def structure(plant):
    return SimpleNamespace(plant=plant)


def refused(effect_id, gain, check, ratio=1.0, base=PLAIN):
    effect = base.layout.effect(effect_id)
    start = {p.symbol: p.starts[0] * p.si for p in effect.parameters}
    weight = Weight(gain, check, ratio, runs_worse=True)
    return effect, weight, structure(base.with_effect(effect_id, start))


def explanation(*near):
    bare = structure(PLAIN)
    return Explanation(bare, bare, (), {}, tuple(near))


@pytest.fixture(autouse=True)
def _no_simulations(monkeypatch):
    monkeypatch.setattr(helpers, "simulates_worse", lambda *_: False)


@pytest.mark.parametrize(
    ("gain", "check", "ratio", "helps"),
    [
        (7.0, 3.1, 1.0, True),
        (7.0, 2.9, 1.0, False),
        (35.0, -1.0, 1.0, False),
        (35.0, -1.0, 0.99, True),
        (-1.0, 40.0, 1.0, False),
    ],
)
def test_a_refused_effect_helps_from_ten_nats_on_unless_what_checks_denies_it(gain, check, ratio, helps):
    found = helping(explanation(refused("cogging", gain, check, ratio)), PLAIN)
    assert [one.found[0][0].id for one in found] == (["cogging"] if helps else [])


@pytest.mark.parametrize(("gain", "helps"), [(15.1, True), (14.9, False)])
def test_beside_found_effects_a_refused_one_helps_from_twenty_nats_on(gain, helps):
    found = PLAIN.layout.effect("stiction"), Weight(90.0, 9.0, 0.5, runs_worse=False)
    beside = replace(explanation(refused("cogging", gain, 5.0)), found=(found,))
    assert len(helping(beside, PLAIN)) == helps


def test_the_most_helpful_comes_first_with_the_others_for_its_rivals():
    near = [refused("cogging", 40.0, 1.0), refused("stiction", 60.0, 5.0), refused("gravity_load", 35.0, 1.0)]
    near.append(refused("spring_load", 31.0, 1.0))
    first, second, third = helping(explanation(*near), PLAIN)
    assert [one.found[0][0].id for one in (first, second, third)] == ["stiction", "cogging", "gravity_load"]
    rivals = {one.effect.id: one.behind for one in first.rivals["stiction"]}
    assert rivals == pytest.approx({"cogging": 24.0, "gravity_load": 29.0, "spring_load": 33.0})
    assert first.best.plant.active == PLAIN.active | {"stiction"}


def test_what_was_tried_beside_an_effect_that_has_gone_is_not_looked_at():
    beside = PLAIN.with_effect("backlash", {"gap": 0.1, "load_inertia": 5e-4})
    assert helping(explanation(refused("cogging", 90.0, 9.0, base=beside)), PLAIN) == []


LACKING = replace(QUIET, left_nats=100.0, torque_before=0.1, torque_after=0.1)
NAMED = replace(FOUND, nearer=0.3, surprise=0.5, remaining=9.0)
SILENT = replace(LACKING, matters=False)
LACKING_MORE = replace(NAMED, moved=9.0)


class Evidence(SimpleNamespace):
    """As much of the evidence as the second look needs; `replace` works on it."""

    def __replace__(self, **changes):
        return Evidence(**{**vars(self), **changes})


def evidence(record, error):
    errors = SimpleNamespace(rms=[error], seconds=(2.0,))
    problem = SimpleNamespace(window_s=2.0)
    return Evidence(record=record, final_errors=errors, problem=problem, explanation=None, needless=("x",))


@pytest.fixture(autouse=True)
def clear_sizes(monkeypatch):
    """Each effect's size is clear of zero, unless a test says otherwise."""
    monkeypatch.setattr(inquiry, "vague_effect", lambda _: None)


@pytest.mark.parametrize(
    ("record", "error", "helps"),
    [(NAMED, 4.9, False), (NAMED, 5.1, True), (replace(NAMED, surprise=99.0, nearer=0.6), 1.0, True)],
)
def test_a_refused_effect_is_named_where_unseen_readings_bear_it_out(monkeypatch, record, error, helps):
    more = evidence(record, error)
    monkeypatch.setattr(inquiry, "with_refused", lambda *_: iter([None]))
    monkeypatch.setattr(inquiry, "gather", lambda *_: more)
    monkeypatch.setattr(inquiry, "nearest_horizon", lambda *_: 0)
    monkeypatch.setattr(inquiry, "replace", lambda one, **changes: _replaced(one, changes))
    told: list[str] = []
    found = inquiry._reconsidered(None, evidence(LACKING, 10.0), None, told.append)
    assert found.record.helps is helps
    assert (inquiry.verdict_of(found.record) == "unexplained") is helps
    assert found.needless == ("x",)
    assert len(told) == 1


def _replaced(one, changes):
    return one.__replace__(**changes) if isinstance(one, Evidence) else replace(one, **changes)


@pytest.mark.parametrize(
    ("record", "error", "named"),
    [
        (replace(NAMED, remaining=1.01), 6.4, True),
        (replace(NAMED, remaining=1.01), 6.6, False),
        (replace(NAMED, matters=True, moved=9.0), 6.4, True),
    ],
)
def test_a_second_effect_is_named_where_unseen_readings_are_a_third_nearer(monkeypatch, record, error, named):
    more = evidence(replace(NAMED, named=2), error)
    monkeypatch.setattr(inquiry, "with_refused", lambda *_: iter([None]))
    monkeypatch.setattr(inquiry, "gather", lambda *_: more)
    monkeypatch.setattr(inquiry, "nearest_horizon", lambda *_: 0)
    monkeypatch.setattr(inquiry, "replace", lambda one, **changes: _replaced(one, changes))
    before = evidence(record, 10.0)
    told: list[str] = []
    found = inquiry._reconsidered(None, before, None, told.append)
    assert found.record.named == (2 if named else 1)
    assert (found is before) is not named


def test_a_second_effect_whose_size_is_hardly_clear_of_zero_is_not_named(monkeypatch):
    monkeypatch.setattr(inquiry, "with_refused", lambda *_: iter([None]))
    monkeypatch.setattr(inquiry, "gather", lambda *_: evidence(replace(NAMED, named=2), 5.0))
    monkeypatch.setattr(inquiry, "nearest_horizon", lambda *_: 0)
    monkeypatch.setattr(inquiry, "replace", lambda one, **changes: _replaced(one, changes))
    monkeypatch.setattr(inquiry, "vague_effect", lambda _: "clock_skew")
    before = evidence(replace(NAMED, remaining=1.5), 10.0)
    assert inquiry._reconsidered(None, before, None, lambda _: None) is before


@pytest.mark.parametrize(("record", "found"), [(NAMED, True), (replace(NAMED, moved=9.0), False)])
def test_an_adequate_plant_that_errs_by_more_than_matters_is_looked_at_again(monkeypatch, record, found):
    more, before = evidence(record, 4.9), evidence(replace(SILENT, remaining=1.1), 10.0)
    monkeypatch.setattr(inquiry, "with_refused", lambda *_: iter([None]))
    monkeypatch.setattr(inquiry, "gather", lambda *_: more)
    monkeypatch.setattr(inquiry, "nearest_horizon", lambda *_: 0)
    monkeypatch.setattr(inquiry, "replace", lambda one, **changes: _replaced(one, changes))
    chosen = inquiry._reconsidered(None, before, None, lambda _: None)
    assert chosen.record.found is found
    assert (chosen is before) is not found


@pytest.mark.parametrize("record", [replace(SILENT, remaining=1.0), replace(NAMED, remaining=1.0)])
def test_what_is_adequate_or_explained_is_not_looked_at_again(monkeypatch, record):
    monkeypatch.setattr(inquiry, "with_refused", lambda *_: pytest.fail("looked again"))
    before = evidence(record, math.inf)
    told: list[str] = []
    assert inquiry._reconsidered(None, before, None, told.append) is before


def with_effects(record, error, *effect_ids):
    found = tuple((PLAIN.layout.effect(each), None) for each in effect_ids)
    made = evidence(record, error)
    made.explanation = SimpleNamespace(found=found)
    return made


@pytest.mark.parametrize(
    ("by_steps", "error", "by_windows", "kept"),
    [
        (LACKING_MORE, 4.9, LACKING, True),
        (LACKING_MORE, 5.1, LACKING, False),
        (LACKING_MORE, 4.9, replace(SILENT, remaining=1.1), True),
        (LACKING_MORE, 4.9, replace(SILENT, remaining=1.0), False),
        (NAMED, 4.9, LACKING, False),
    ],
)
def test_what_steps_found_stays_where_windows_find_nothing_and_err_by_what_matters(
    monkeypatch, by_steps, error, by_windows, kept
):
    monkeypatch.setattr(inquiry, "nearest_horizon", lambda *_: 0)
    steps, windows = with_effects(by_steps, error, "end_stop"), with_effects(by_windows, 10.0)
    assert inquiry._nearer(steps, windows) is (steps if kept else windows)


@pytest.mark.parametrize(
    ("found", "also", "error", "kept"),
    [
        (("end_stop", "missed_counts"), ("end_stop",), 6.4, True),
        (("end_stop", "missed_counts"), ("end_stop",), 6.6, False),
        (("end_stop",), ("end_stop",), 6.4, False),
        (("missed_counts",), ("end_stop",), 6.4, False),
    ],
)
def test_what_steps_found_beyond_windows_stays_where_it_brings_them_nearer(
    monkeypatch, found, also, error, kept
):
    monkeypatch.setattr(inquiry, "nearest_horizon", lambda *_: 0)
    steps = with_effects(LACKING_MORE, error, *found)
    windows = with_effects(LACKING_MORE, 10.0, *also)
    assert inquiry._nearer(steps, windows) is (steps if kept else windows)
