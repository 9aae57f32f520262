"""Trials that are settled in another way, since a draft or a first fit of them came to rest too early."""

from types import SimpleNamespace

import pytest

from nxt_twin.diagnose.search import trials as trying
from nxt_twin.diagnose.search.trials import Trials
from nxt_twin.diagnose.search.weight import Weight


def effect(name, *terms):
    return SimpleNamespace(id=name, terms=dict.fromkeys(terms))


def structure(*effects, noise="own"):
    plant = SimpleNamespace(effects=effects, active=frozenset(each.id for each in effects))
    return SimpleNamespace(plant=plant, noise=noise)


def trials(**parts):
    made = object.__new__(Trials)
    for name, part in parts.items():
        setattr(made, name, part)
    return made


@pytest.mark.parametrize(
    ("gain", "ratio", "again"), [(-1.0, 0.49, True), (1.0, 0.49, False), (-1.0, 0.51, False)]
)
def test_what_simulates_much_nearer_and_is_not_likelier_is_settled_once_more(monkeypatch, gain, ratio, again):
    monkeypatch.setattr(trying, "weigh", lambda *_: Weight(gain, 0.0, ratio, runs_worse=False))
    made = trials(_settled=SimpleNamespace(settle=lambda _, noise: f"under the noise of {noise}"))
    trial = structure()
    expected = "under the noise of the best" if again else trial
    assert made._rested(structure(noise="the best"), trial) == expected


@pytest.mark.parametrize(
    ("found", "settled"),
    [
        ((), 1),
        ((effect("late", "outlier"),), 1),
        ((effect("late", "outlier"), effect("drag", "friction")), 1),
        ((effect("drag", "friction"),), 0),
    ],
)
def test_a_broken_promise_is_settled_at_first_and_beside_late_stamps(found, settled):
    promising = effect("load", "torque")
    prospect = SimpleNamespace(effect=promising, plant=None, gain=20.0)
    made = trials(
        _standard=SimpleNamespace(needed=lambda _: 8.0),
        _fits=SimpleNamespace(first_noise=lambda: "first", problem=SimpleNamespace(plant=structure().plant)),
        _drafts=SimpleNamespace(prospects=lambda *_: {"load": [prospect]}),
        _settled=SimpleNamespace(settle=lambda *_: structure()),
    )
    worse = [(promising, SimpleNamespace(cost=1.0))]
    assert len(made._rugged(structure(*found), 0.0, worse, set(), 0.0)) == settled


def far_from_given():
    """A structure whose fit has moved the given numbers far."""
    home = SimpleNamespace(values={}, with_values=lambda _: home)
    return SimpleNamespace(plant=home, noise="own", fitted=SimpleNamespace(prior_cost=3.0))


@pytest.mark.parametrize(("fault", "asked"), [(False, ["load"]), (True, [])])
def test_no_fault_of_the_readings_is_looked_for_from_the_given_numbers(fault, asked):
    one, best = SimpleNamespace(id="load", fault=fault), far_from_given()
    seen: list[str] = []
    made = trials(
        candidates=lambda _: [one],
        _fits=SimpleNamespace(problem=SimpleNamespace(plant=best.plant), standing=lambda *_: best),
        _drafts=SimpleNamespace(of=lambda _, effects, __: seen.extend(each.id for each in effects) or []),
    )
    assert made._restoring(best, set(), "the leader's") == []
    assert seen == asked


def test_from_the_given_numbers_effects_are_looked_for_under_the_noise_of_the_leader():
    one, best = SimpleNamespace(id="load", fault=False), far_from_given()
    under: list[str] = []
    made = trials(
        candidates=lambda _: [one],
        _fits=SimpleNamespace(
            problem=SimpleNamespace(plant=best.plant), standing=lambda _, noise: under.append(noise) or best
        ),
        _drafts=SimpleNamespace(
            of=lambda *_: [(one, SimpleNamespace(fitted=SimpleNamespace(plant="drafted")))]
        ),
    )
    (start,) = made._restoring(best, set(), "the leader's")
    assert under == [start.noise] == ["the leader's"]
    assert start.plant == "drafted"


@pytest.mark.parametrize(
    ("found", "tried"),
    [("stop", True), ("drag", False)],
)
def test_lost_counts_are_tried_from_several_shares_beside_what_lies_in_the_angle(monkeypatch, found, tried):
    loss = SimpleNamespace(id="loss", counted=True)
    monkeypatch.setattr(trying, "lies_in_angle", lambda each: each.id == "stop")
    monkeypatch.setattr(trying, "losing", lambda *_: [3.0, 1.0, 2.0])
    made = trials(
        candidates=lambda _: [loss, SimpleNamespace(id="load", counted=False)],
        _fits=SimpleNamespace(
            problem=SimpleNamespace(plant=structure().plant),
            draft=lambda cost, *_, **__: SimpleNamespace(cost=cost),
            drafted_cost=lambda *_: 0.0,
            abreast=lambda function, items: [function(item) for item in items],
        ),
    )
    starts = made._losing(structure(effect(found)))
    assert [(start.effect.id, start.plant) for start in starts] == (
        [("loss", 1.0), ("loss", 2.0), ("loss", 3.0)] if tried else []
    )


def test_of_several_starts_of_an_effect_the_likeliest_counts():
    loss, load = SimpleNamespace(id="loss"), SimpleNamespace(id="load")
    ends = [SimpleNamespace(fitted_cost=cost) for cost in (3.0, 0.0, 1.0, 2.0)]
    found = trying._likeliest([*zip((loss, load, loss, loss), ends, strict=True)])
    assert found == [(load, ends[1]), (loss, ends[2])]


@pytest.mark.parametrize(
    ("gain", "slip", "listed", "tried"),
    [
        (8.0, 0.0, set(), True),
        (7.9, 0.0, set(), False),
        (8.0, 1e-3, set(), False),
        (8.0, 0.0, {"loss"}, False),
    ],
)
def test_lost_counts_are_tried_where_their_chance_alone_gains_what_is_needed(
    monkeypatch, gain, slip, listed, tried
):
    loss = SimpleNamespace(id="loss", counted=True)
    monkeypatch.setattr(trying, "chance_alone", lambda *_: (gain, 0.03, "wandering"))
    monkeypatch.setattr(trying, "wandering", lambda *parts: ("plant", *parts[-2:]))
    made = trials(
        candidates=lambda _: [loss, SimpleNamespace(id="load", counted=False)],
        _fits=None,
        _standard=SimpleNamespace(needed=lambda _: 8.0),
    )
    starts = made._by_chance(structure(noise=SimpleNamespace(slip=slip)), listed)
    wanted = [(loss, ("plant", 0.03, "wandering"), "wandering")] if tried else []
    assert [(start.effect, start.plant, start.noise) for start in starts] == wanted
