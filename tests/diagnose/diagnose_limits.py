"""What a search of which only some parts are there answers to a number that one of its limits judges."""

import math
from dataclasses import dataclass
from functools import partial
from types import SimpleNamespace

import pytest

from nxt_twin.diagnose.search import begun as beginning
from nxt_twin.diagnose.search import explain as explaining
from nxt_twin.diagnose.search import rivals as rivalry
from nxt_twin.diagnose.search import sharing
from nxt_twin.diagnose.search import standard as standards
from nxt_twin.diagnose.search import trials as trying
from nxt_twin.diagnose.search.coincidence import coincidence_nats
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
        commoner_nats=0.0,
        fault=False,
        source=source,
        states=states,
        confusable_with=(),
        supersedes=supersedes,
        terms={},
        counted=False,
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


def lasts(
    gain, moments, error=2.1, elsewhere=0.0, *, check=0.0, shows=("high_load",), ratio=1.0, second="size"
):
    """Whether a further effect's gain lasts, beside one that leaves an `error` of so many tolerances.

    `second` is the name of its second parameter.
    """
    fits = SimpleNamespace(
        moments_gained=lambda *_: moments,
        gained_elsewhere=lambda *_: elsewhere,
        problem=SimpleNamespace(tolerance=1.0),
    )
    standard = Standard(fits, structure(), SimpleNamespace())
    weight = Weight(gain, check, ratio, runs_worse=False)
    richer = structure("a", "b")
    added = effect_named("b", starts=((1.0,), ()))
    added.shows, added.parameters[1].name = shows, second
    richer.plant.effects = (added,)
    return standard.lasts(weight, structure("a", error=error), richer)


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


def one_by_one(function, items):
    """As `Simulator.abreast` does it where it has one worker."""
    return [function(item) for item in items]


def settled_by(settle, **parts):
    """What `settle` gives for a plant and its noise is settled."""
    each = partial(one_by_one, lambda start: settle(*start))
    return SimpleNamespace(settle=settle, settle_each=each, **parts)


def search(**parts):
    """A search of which only some parts are there."""
    made = object.__new__(explaining._Search)
    made.baseline = structure()
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
    problem = SimpleNamespace(plant=SimpleNamespace(values={}))
    fits = SimpleNamespace(problem=problem, standing=lambda *_: structure())
    draft = SimpleNamespace(fitted=SimpleNamespace(plant=None))
    made = trials(
        _fits=fits,
        candidates=lambda _: effects,
        _drafts=SimpleNamespace(of=lambda _, fresh, most: [(one, draft) for one in fresh[:most]]),
        _settled=settled_by(lambda *_: structure()),
    )
    return len(made._restoring(best, {"0", "1", "2", "3"}, "the leader's"))


def rugged(*promised, cost=1.0, listed=frozenset(), found=(), led=0.0):
    """How many effects that promise so much are settled, where 8 nats are needed and each draft costs `cost` more.

    The leader gained `led`.
    """
    effects = [effect_named(str(n)) for n in range(len(promised))]
    pairs = zip(effects, promised, strict=True)
    prospects = {e.id: [SimpleNamespace(effect=e, plant=None, gain=nats)] for e, nats in pairs}
    made = trials(
        _standard=SimpleNamespace(needed=lambda _: 8.0),
        _fits=SimpleNamespace(
            first_noise=lambda: "first", problem=SimpleNamespace(plant=SimpleNamespace(active=frozenset()))
        ),
        _drafts=SimpleNamespace(prospects=lambda *_: prospects),
        _settled=settled_by(lambda _, noise: noise),
    )
    drafts = [(e, SimpleNamespace(cost=cost)) for e in effects]
    best = structure(*found)
    best.plant.effects = tuple(effect_named(each) for each in found)
    starts = made._rugged(best, 0.0, drafts, listed, led)
    assert all(start.noise == "first" for start in starts)
    return len(starts)


def losses(monkeypatch, *costs):
    """The shares of lost counts that are settled, of those whose drafts cost so much; the structure costs nothing."""
    monkeypatch.setattr(trying, "losing", lambda *_: list(range(len(costs))))
    fits = SimpleNamespace(
        draft=lambda plant, *_, **__: SimpleNamespace(cost=costs[plant]),
        drafted_cost=lambda *_: 0.0,
        abreast=one_by_one,
    )
    return trials(_fits=fits)._losses(structure(), effect_named("missed"))


@dataclass(frozen=True)
class _Noise:
    disturbance_std: float


def shared_anew_with(effect, gain, *, slack_gain=0.0):
    """What is tried with the shares of `effect` where a round is likelier by `gain`, and what its end costs.

    A start from less friction is likelier by `slack_gain`.
    """
    tried = []
    own, larger = _Noise(5.0), _Noise(100.0)

    def at(cost):
        plant = SimpleNamespace(with_values=lambda new: SimpleNamespace(cost=cost, shares=[*new.values()]))
        return SimpleNamespace(plant=plant, noise=own, fitted_cost=cost)

    def settle(plant, noise):
        tried.append((*plant.shares, noise.disturbance_std))
        gains = {own: 0.0, larger: gain}
        return at(plant.cost - gains.get(noise, slack_gain))

    rubbing = {Slot("coulomb_friction", "coulomb"): 0.1}
    best = SimpleNamespace(noise=larger, plant=SimpleNamespace(values=rubbing))
    end = sharing.shared_anew(settled_by(settle), best, at(0.0), effect)
    return SimpleNamespace(tried=tried, cost=end.fitted_cost)


def is_kept(monkeypatch, total):
    monkeypatch.setattr(explaining, "weigh", lambda *_: Weight(total - 1.0, 1.0, 1.0, runs_worse=False))
    standard = SimpleNamespace(is_notable=lambda *_: True)
    settled, fits = SimpleNamespace(without=lambda *_: structure()), SimpleNamespace(abreast=one_by_one)
    made = search(_standard=standard, _settled=settled, _fits=fits)
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
        _settled=settled_by(lambda *_: structure()),
    )
    drafts = [SimpleNamespace(cost=-gain, fitted=SimpleNamespace(plant=None)) for gain in (0.0, promise)]
    pairs = [(effect_named(str(n)), one) for n, one in enumerate(drafts)]
    settled, starts = made._leaders(structure(), 0.0, pairs)
    return len(settled) + len(starts)


def sober_std(monkeypatch):
    seen = []

    def drafted(_, noise, *, iterations):
        seen.append((noise.disturbance_std, iterations))
        raise ReachedError

    monkeypatch.setattr(trying, "is_mechanical", lambda _: True)
    monkeypatch.setattr(trying, "replace", lambda noise, **new: SimpleNamespace(**{**vars(noise), **new}))
    prospects = SimpleNamespace(prospects=lambda *_: {"a": [SimpleNamespace(plant=None)]})
    with pytest.raises(ReachedError):
        trials(_drafts=prospects, _fits=SimpleNamespace(draft=drafted, abreast=one_by_one))._settled_anew(
            structure(), effect_named(), structure(), shares=True
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
        trials(_fits=SimpleNamespace(problem=problem), candidates=reached)._scattering(best, set())
    except ReachedError:
        return True
    return False


def rounds(monkeypatch, gain=10.0):
    """How often a search grows that finds a likelier rival each time, by `gain` nats."""
    grown = []

    class Searching:
        def __init__(self, _, baseline, *, known):
            assert known == ()
            self.baseline = baseline

        loud = frozenset()

        def begun(self):
            return self.baseline

        def unnamed(self, _):
            return ()

        def grown(self, best, _):
            grown.append(best)
            return best, ()

        def placed(self, *_):
            return (), {}

        def untaken(self, _):
            return ()

        def pruned(self, _):
            return structure(cost=-gain * len(grown))

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


def begun_by(patch, gain, *, cost=0.0):
    """Whether recordings begin with moments of their own that gain so much for each of two, fitted at that cost."""
    patch.setattr(beginning, "lengths_s", lambda _: {"a": 9.0, "b": 9.0})
    patch.setattr(beginning, "replace", lambda one, **changed: SimpleNamespace(**{**vars(one), **changed}))
    problem = SimpleNamespace(leaning={})
    best, own = structure(), structure("own", cost=cost)
    patch.setattr(beginning, "_cost_of_all", lambda *of: -2.0 * gain if of[1].structure is own else 0.0)
    look = SimpleNamespace(problem=problem, structure=own, effect=effect_named())
    return beginning.likeliest_begun(None, problem, best, [look]) is not None


def most_beside():
    """How many found effects there may be at most beside which moments of their own are looked for."""
    bare = structure()
    found = [structure(*(str(n) for n in range(count))) for count in range(1, 9)]
    explained = [SimpleNamespace(baseline=bare, best=one) for one in found]
    return sum(len(beginning.bases(one)) == 2 for one in explained)
