"""Each limit of the search and of its effort: on either side of it, a few hundredths apart, the answer is another."""

import math
from dataclasses import fields
from types import SimpleNamespace

import pytest
from diagnose_second_wave import has_second_wave

from nxt_twin.diagnose.search import explain as explaining
from nxt_twin.diagnose.search import rivals as rivalry
from nxt_twin.diagnose.search import standard as standards
from nxt_twin.diagnose.search import trials as trying
from nxt_twin.diagnose.search.coincidence import coincidence_nats
from nxt_twin.diagnose.search.limits import SearchEffort, SearchLimits
from nxt_twin.diagnose.search.rivals import Rival, likelier_structure, simulates_worse
from nxt_twin.diagnose.search.standard import Standard
from nxt_twin.diagnose.search.weight import Weight
from nxt_twin.diagnose.telling.findings import near_rivals
from nxt_twin.physics.layout import Slot


def effect_named(name="a", *, states=(), source="a book", starts=((1.0,),), supersedes=()):
    parameters = tuple(
        SimpleNamespace(name="size", frozen=False, doubt=math.inf, starts=own) for own in starts
    )
    return SimpleNamespace(
        id=name,
        parameters=parameters,
        plain=False,
        fault=False,
        source=source,
        states=states,
        confusable_with=(),
        supersedes=supersedes,
        terms={},
    )


def structure(*effects, cost=0.0, error=2.0, prior_cost=0.0):
    plant = SimpleNamespace(effects=(), active=frozenset(effects))
    noise = SimpleNamespace(disturbance_std=1.0, reading_std=1.0)
    fitted = SimpleNamespace(prior_cost=prior_cost)
    return SimpleNamespace(
        plant=plant, fitted=fitted, fitted_cost=cost, check_cost=0.0, free_run_rms=(error,), noise=noise
    )


def likelier(gain, *, check=2.5, ratio=1.0, explained=0.0, silent=False, effect=None, by_windows=False):
    """Whether an effect with such a weight earns its place beside effects that have `explained` so many nats."""
    problem = SimpleNamespace(tolerance=1.0, by_windows=by_windows, leaning={})
    standard = Standard(SimpleNamespace(problem=problem), structure(), SimpleNamespace())
    best = structure(cost=-explained, error=0.5 if silent else 2.0)
    return standard.likelier(effect or effect_named(), Weight(gain, check, ratio, runs_worse=False), best)


def belief(effect, *, by_windows=False):
    """The log prior odds of an effect, nats."""
    problem = SimpleNamespace(by_windows=by_windows, leaning={})
    return Standard(SimpleNamespace(problem=problem), structure(), SimpleNamespace()).belief(effect)


def lasts(gain, moments, error=2.1, elsewhere=0.0, *, check=0.0, shows=("high_load",)):
    """Whether a further effect's gain lasts, beside one that leaves an `error` of so many tolerances."""
    fits = SimpleNamespace(
        moments_gained=lambda *_: moments,
        gained_elsewhere=lambda *_: elsewhere,
        problem=SimpleNamespace(tolerance=1.0),
    )
    standard = Standard(fits, structure(), SimpleNamespace())
    weight = Weight(gain, check, 1.0, runs_worse=False)
    richer = structure("a", "b")
    richer.plant.effects = (SimpleNamespace(id="b", shows=shows),)
    return standard.lasts(weight, structure("a", error=error), richer)


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
    ("ratio", "share"), [(0.5, 0.04), (0.65, 0.04), (0.825, 0.145), (1.0, 0.25), (1.2, 0.25)]
)
def test_a_silent_simulation_asks_for_more_the_less_nearer_it_gets(ratio, share):
    assert not likelier(1e3 * share - 1.0, explained=1e3, silent=True, ratio=ratio, check=2.5)
    assert likelier(1e3 * share + 1.0, explained=1e3, silent=True, ratio=ratio, check=2.5)


def is_late(age_polls):
    """Whether an effect that doubts readings of that age has a name, polls of 10 ms."""
    problem = SimpleNamespace(signals=(SimpleNamespace(interval_s=0.01),))
    fits = SimpleNamespace(problem=problem, lateness_s=lambda _: 0.01 * age_polls)
    standard = Standard(fits, structure(), SimpleNamespace())
    return standard.is_late(structure(), SimpleNamespace(terms={"outlier": None}))


def is_heard(monkeypatch, gain=101.0, check=41.0, ratio=0.49, error=2.1, supersedes=(), small=False):
    """Whether an effect that is too small for a name has one, as it is so loud beside an `error` in tolerances."""
    monkeypatch.setattr(standards, "weigh", lambda *_: Weight(gain, check, ratio, runs_worse=False))
    monkeypatch.setattr(standards, "is_hardly_too_small", lambda *_: not small)
    problem = SimpleNamespace(tolerance=1.0, scale=None)
    standard = Standard(SimpleNamespace(problem=problem), structure(), SimpleNamespace())
    effect = effect_named("a", supersedes=supersedes)
    heard = standard.hear(structure(error=error), structure("a"), effect)
    assert standard.loud == (frozenset({"a"}) if heard else frozenset())
    return heard


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


def swapped(behind):
    return likelier_structure({"a": (Rival(effect_named("b"), behind, structure(), simulates_worse=False),)})


def rival_is_worse(monkeypatch, ratio, total=0.0, states=()):
    monkeypatch.setattr(rivalry, "weigh", lambda *_: Weight(total + 1.0, -1.0, 1.0, runs_worse=False))
    monkeypatch.setattr(rivalry, "free_run_ratio", lambda *_: ratio)
    return simulates_worse(structure(), structure(), effect_named(states=states))


def is_near(behind, *, is_twin=False):
    rival = Rival(effect_named("b"), behind, structure(), simulates_worse=False, is_twin=is_twin)
    told = SimpleNamespace(found=((effect_named("a"), None),), rivals={"a": (rival,)})
    return bool(near_rivals(SimpleNamespace(explanation=told)))


def search(**parts):
    """A search of which only some parts are there."""
    made = object.__new__(explaining._Search)
    made._baseline = structure()
    made._tried = []
    made._unnamed = set()
    for name, part in parts.items():
        setattr(made, name, part)
    return made


def trials(**parts):
    """A choice of trials of which only some parts are there."""
    made = object.__new__(trying.Trials)
    for name, part in parts.items():
        setattr(made, name, part)
    return made


def effects_grown():
    """How many effects a search adds of which each earns its place."""

    def added(best, *_):
        count = len(best.plant.active) + 1
        return structure(*map(str, range(count)), cost=-100.0 * count)

    one = (effect_named("z"), Weight(9.0, 9.0, 1.0, runs_worse=False), None)
    grown, _ = search(_forward=lambda _: ([one], []), _added=added).grown(structure(), lambda _: None)
    return len(grown.plant.active)


def is_taken(gain):
    """Whether a structure with the same effects and so many nats more is another."""
    one = (effect_named("z"), Weight(9.0, 9.0, 1.0, runs_worse=False), None)
    better = iter([structure(cost=-gain), None])
    grown, _ = search(_forward=lambda _: ([one], []), _added=lambda *_: next(better)).grown(
        structure(), lambda _: None
    )
    return grown.fitted_cost < 0.0


def restored(prior_cost):
    """How many effects are settled from the given numbers where those that were found cost so much."""
    effects = [effect_named(str(n)) for n in range(9)]
    best = structure(prior_cost=prior_cost)
    best.plant.values, best.plant.with_values = {}, lambda _: None
    fits = SimpleNamespace(
        problem=SimpleNamespace(plant=SimpleNamespace(values={})), standing=lambda *_: structure()
    )
    draft = SimpleNamespace(fitted=SimpleNamespace(plant=None))
    made = trials(
        _fits=fits,
        candidates=lambda _: effects,
        _drafts=SimpleNamespace(of=lambda _, fresh, most: [(one, draft) for one in fresh[:most]]),
        _settled=SimpleNamespace(settle=lambda *_: structure()),
    )
    return len(made._restoring(best, {"0"}))


def rugged(*promised, cost=1.0, listed=frozenset(), found=()):
    """How many effects that promise so much are settled, where 8 nats are needed and each draft costs `cost` more."""
    effects = [effect_named(str(n)) for n in range(len(promised))]
    pairs = zip(effects, promised, strict=True)
    prospects = {e.id: [SimpleNamespace(effect=e, plant=None, gain=nats)] for e, nats in pairs}
    made = trials(
        _standard=SimpleNamespace(needed=lambda _: 8.0),
        _fits=SimpleNamespace(
            first_noise=lambda: "first", problem=SimpleNamespace(plant=SimpleNamespace(active=frozenset()))
        ),
        _drafts=SimpleNamespace(prospects=lambda *_: prospects),
        _settled=SimpleNamespace(settle=lambda _, noise: noise),
    )
    drafts = [(e, SimpleNamespace(cost=cost)) for e in effects]
    best = structure(*found)
    best.plant.effects = tuple(effect_named(each) for each in found)
    settled = made._rugged(best, 0.0, drafts, listed)
    assert all(noise == "first" for _, noise in settled)
    return len(settled)


def is_kept(monkeypatch, total):
    monkeypatch.setattr(explaining, "weigh", lambda *_: Weight(total - 1.0, 1.0, 1.0, runs_worse=False))
    standard = SimpleNamespace(is_notable=lambda *_: True)
    made = search(_standard=standard, _settled=SimpleNamespace(without=lambda *_: structure()))
    return bool(made.pruned(structure("a")).plant.active)


def rivals_of(*costs, known=0):
    """How many rivals are listed: drafts with such costs, and some that were settled before."""
    effects = [effect_named(str(n)) for n in range(len(costs) + known)]
    drafts = dict(zip((effect.id for effect in effects[known:]), costs, strict=True))

    def drafted(_, fresh, most):
        plant = SimpleNamespace(plant=None)
        return [(one, SimpleNamespace(cost=drafts[one.id], fitted=plant)) for one in fresh[:most]]

    ready = {one.id for one in effects[:known]}
    settled = SimpleNamespace(
        without=lambda *_: structure(),
        with_effect=lambda _, one: structure() if one.id in ready else None,
        settle=lambda *_: structure(),
    )
    made = search(
        _settled=settled,
        _tried=effects,
        _trials=SimpleNamespace(candidates=lambda _: effects),
        _drafts=SimpleNamespace(of=drafted),
        _fits=SimpleNamespace(drafted_cost=lambda *_: 0.0),
        _standard=SimpleNamespace(is_notable=lambda *_: True),
        _rival=lambda _best, _effect, other, _trial: SimpleNamespace(
            doubt_nats=0.0, structure=None, effect=other
        ),
    )
    return len(made.rivals(structure("found"), effect_named("found")))


class ReachedError(Exception):
    """Raised to end a search at the step that is asked for."""


def forward(*gains, states=()):
    """What a step forward drafts, and which drafts with such gains it looks at: most, least nats, their number."""
    seen = {}

    def drafted(_, __, most, least):
        seen.update(most=most, least=least)
        return [
            (effect_named(str(n), states=states), SimpleNamespace(cost=-gain)) for n, gain in enumerate(gains)
        ]

    def leaders(_, __, within):
        seen.update(within=len(within))
        raise ReachedError

    made = trials(
        _standard=SimpleNamespace(needed=lambda _: 8.0),
        _drafts=SimpleNamespace(of=drafted),
        _fits=SimpleNamespace(drafted_cost=lambda *_: 0.0),
        candidates=lambda _: [],
        _leaders=leaders,
    )
    with pytest.raises(ReachedError):
        made.beside(structure())
    return seen


def leaders(promise):
    """How many of two drafts are settled, where 110 nats are needed and the second promises so many."""
    made = trials(
        _standard=SimpleNamespace(needed=lambda _: 110.0),
        _settled=SimpleNamespace(settle=lambda *_: structure()),
    )
    drafts = [SimpleNamespace(cost=-gain, fitted=SimpleNamespace(plant=None)) for gain in (0.0, promise)]
    return len(made._leaders(structure(), 0.0, [(effect_named(str(n)), one) for n, one in enumerate(drafts)]))


def sober_std(monkeypatch):
    seen = []

    def drafted(_, noise, *, iterations):
        seen.append((noise.disturbance_std, iterations))
        raise ReachedError

    monkeypatch.setattr(trying, "is_mechanical", lambda _: True)
    monkeypatch.setattr(trying, "replace", lambda noise, **new: SimpleNamespace(**{**vars(noise), **new}))
    prospects = SimpleNamespace(prospects=lambda *_: {"a": [SimpleNamespace(plant=None)]})
    with pytest.raises(ReachedError):
        trials(_drafts=prospects, _fits=SimpleNamespace(draft=drafted))._settled_anew(
            structure(), effect_named(), structure()
        )
    return seen[0][0]


def is_rough(monkeypatch, quanta):
    """Whether held readings are looked for where readings scatter by so many times an encoder's step."""

    def reached(_):
        raise ReachedError

    problem = SimpleNamespace(signals=[SimpleNamespace(quantum=math.sqrt(12.0))])
    best = structure()
    best.noise.reading_std = quanta
    monkeypatch.setattr(trying, "replace", lambda noise, **_: noise)
    try:
        trials(_fits=SimpleNamespace(problem=problem), candidates=reached)._scattering(best, [])
    except ReachedError:
        return True
    return False


def rounds(monkeypatch):
    """How often a search grows that finds a likelier rival each time."""
    grown = []

    class Searching:
        def __init__(self, _, baseline):
            self._baseline = baseline

        loud = frozenset()

        def begun(self):
            return self._baseline

        def unnamed(self, _):
            return ()

        def grown(self, best, _):
            grown.append(best)
            return best, ()

        def found(self, _):
            return ()

        def pruned(self, best):
            return best

    monkeypatch.setattr(explaining, "_Search", Searching)
    monkeypatch.setattr(explaining, "likelier_structure", lambda _: structure())
    explaining.explain(None, structure(), lambda _: None)
    return len(grown)


def comb(starts):
    return standards._choice_nats(effect_named(starts=((1.0,), (1.0,) * starts)))


def against_a_hidden_load():
    """What speaks against a load that friction hides, and against one that it cannot hide."""
    effect = effect_named("constant_load")
    effect.parameters[0].symbol = "load"
    friction = {Slot("coulomb_friction", "coulomb"): 1.0}
    plants = [
        SimpleNamespace(values={**friction, Slot("constant_load", "load"): load}) for load in (0.9, 1.1)
    ]
    return [coincidence_nats(plant, effect) for plant in plants]


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
    "odd_tolerances": (lambda _, v: lasts(1e4, 9.0, v, 7.9), 1.98, 2.02),
    "late_polls": (lambda _, v: is_late(v), 0.24, 0.26),
    "keep_nats": (is_kept, 2.95, 3.05),
    "swap_nats": (lambda _, v: swapped(v) is None, -0.98, -1.02),
    "rival_nats": (lambda _, v: is_near(v), 7.9, 8.1),
    "twin_nats": (lambda _, v: is_near(v, is_twin=True), 148.0, 152.0),
    "rival_ratio": (rival_is_worse, 1.025, 1.035),
    "sure_rival_ratio": (lambda patch, v: rival_is_worse(patch, v, -150.0, ("twist",)), 1.29, 1.31),
    "sure_nats": (lambda patch, v: rival_is_worse(patch, 1.2, v, ("twist",)), -99.0, -101.0),
    "better_nats": (lambda _, v: is_taken(v), 0.98, 1.02),
    "rival_reach_nats": (lambda _, v: rivals_of(0.0, v), 39.5, 40.5),
    "far_reach_nats": (lambda _, v: rivals_of(v), 398.0, 402.0),
    "slack_nats": (lambda _, v: forward(100.0, -v)["within"], 9.9, 10.1),
    "settled_share": (lambda _, v: forward(100.0, -99.0, v)["within"], 9.9, 10.1),
    "in_reach": (lambda _, v: forward(100.0, *[-99.0] * 5, v, states=("twist",))["within"], 24.5, 25.5),
    "lifted": (lambda _, v: leaders(v), 39.5, 40.5),
    "restoring_nats": (lambda _, v: restored(v), 1.98, 2.02),
    "fine": (is_rough, 1.48, 1.52),
    "comb": (lambda _, v: comb(v) > 0.0, 4, 5),
}
STATED = SimpleNamespace(plain=True, parameters=(SimpleNamespace(frozen=True),), source="a book")
COUNTS = {
    "left_out_nats": (lambda _: belief(STATED), 3.0),
    "coincidence_nats": (lambda _: against_a_hidden_load(), [1.35, 0.0]),
    "most_effects": (lambda _: effects_grown(), 4),
    "rivals_drafted": (lambda _: rivals_of(*[0.0] * 9), 4),
    "short_list": (lambda _: rivals_of(known=9), 5),
    "leading": (lambda _: forward(100.0, 0.0, 0.0, 0.0)["within"], 2),
    "drafted": (lambda _: forward(1.0)["most"], 10),
    "promised": (lambda _: forward(1.0)["least"], pytest.approx(0.8)),
    "exchanges": (rounds, 5),
    "restoring": (lambda _: 1 + restored(10.1), 3),
    "rugged": (lambda _: rugged(20.0, 30.0, 40.0), 2),
    "sober": (sober_std, pytest.approx(0.3)),
}


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


def test_by_windows_a_free_curve_gives_way_to_what_it_cannot_be_told_from():
    assert belief(OWN) == 0.0
    assert belief(OWN, by_windows=True) == -8.0
    assert not likelier(19.9, effect=OWN, by_windows=True)
    assert likelier(20.1, effect=OWN, by_windows=True)


def test_each_limit_has_a_case_at_its_edge():
    every = {field.name for each in (SearchLimits, SearchEffort) for field in fields(each)}
    assert every == EDGES.keys() | COUNTS.keys()
