"""A search begun anew from ways of which only the ends are there."""

from types import SimpleNamespace

from diagnose_limits import structure

from nxt_twin.diagnose.search import searched as searching


def explanation(*untaken, best=None):
    return SimpleNamespace(baseline=structure(), best=best or structure(), unnamed=(), untaken=untaken)


def searched_from(monkeypatch, ends, costs=(0.0, 0.0)):
    """What comes of ways `a`, `b` and so on that end with these sets of effects, and from which places they began.

    `costs` are those of a way as it was and of where a small unknown torque leads it. That torque comes third.
    """
    began, untaken = [], [structure(name, cost=costs[0]) for name, _ in zip("abcdefg", ends, strict=False)]
    noises = []

    def settled(plant, noise):
        noises.append(noise.disturbance_std)
        return structure(*plant.active, cost=costs[1])

    def anew(_, beaten, begin, __):
        began.append((sorted(begin.plant.active), begin.fitted_cost, beaten.best))
        end = ends[len(began) - 1]
        return None if end is None else explanation(best=structure(*end))

    monkeypatch.setattr(searching, "Fits", lambda *_: SimpleNamespace(settled=settled))
    monkeypatch.setattr(searching, "explain_anew", anew)
    monkeypatch.setattr(searching, "_fitted", lambda _, found: found)
    monkeypatch.setattr(searching, "replace", lambda _, **changes: SimpleNamespace(**changes))
    first = explanation(*untaken, best=structure("z"))
    found = list(searching.searched_anew(None, None, first, lambda _: None))
    return [sorted(one.best.plant.active) for one in found], began, noises
