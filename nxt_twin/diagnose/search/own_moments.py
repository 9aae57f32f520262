"""A payload that is put on in each recording anew: tried where one session, end to end, explains nothing."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.own_moments import lengths_s, setting_in
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.search.begun import Begun, bases, likeliest_begun
from nxt_twin.diagnose.search.explain import Explanation
from nxt_twin.diagnose.search.onset import at_onset, has_onset, removed_at
from nxt_twin.diagnose.search.settled import simpler
from nxt_twin.diagnose.search.trials import addable_effects
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.effects.load import NEVER_S
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.parameter import INERTIA
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Simulator

_BODY: Final = Slot(BASE_OWNER, "inertia")
_BODIES: Final = (0.9, 0.75, 0.5, 0.3)  # of the fitted inertia, which what sets in has raised
_ROUNDS: Final = 2  # of finer moments and sizes in turn
_COARSE: Final = 24  # moments over the longest recording, of the first round
_FINER: Final = 10  # times as many in the second; and once more in the third, nearby


def with_own_moments(simulator: Simulator, problem: Problem, explanation: Explanation) -> Begun | None:
    """`problem` with each recording begun so that a payload sets in at one moment in all, and a plant with it.

    None where readings are not likelier by far with moments of their own than with all that was found.
    """
    looks = [
        _look(simulator, problem, before, effect)
        for before in bases(explanation)
        for effect in _with_onset(problem, before)
    ]
    return likeliest_begun(simulator, problem, explanation.best, looks)


def _look(simulator: Simulator, problem: Problem, before: Structure, effect: Effect) -> Begun:
    """`before` with `effect` from the likeliest moment of each recording on, and the problem begun by these moments.

    Moments and sizes are looked for in turn: moments over the whole length of the recordings first, then nearby.
    """
    lengths = lengths_s(problem)
    from_start, longest_s = dict.fromkeys(lengths, 0.0), max(lengths.values())
    everywhere_s = np.linspace(0.0, longest_s, _COARSE + 1)
    finely_s = np.linspace(0.0, longest_s, _COARSE * _FINER + 1)
    nearby_s = np.linspace(-finely_s[1], finely_s[1], 2 * _FINER + 1)
    plants, noise = _sized(Fits(simulator, _begun(problem, from_start)), before.plant, effect), before.noise
    own_s, structure = from_start, before
    for begins_s, shifts_s in (
        (from_start, everywhere_s),
        *[(from_start, finely_s)] * _ROUNDS,
        (None, nearby_s),
    ):
        plant, own_s = _likeliest(simulator, problem, begins_s or own_s, plants, effect, shifts_s, noise)
        structure = Fits(simulator, _begun(problem, own_s)).settled(
            _from(plant, effect, _usual(own_s)), noise
        )
        plants, noise = [structure.plant], structure.noise
    return Begun(_begun(problem, own_s), structure, effect)


def _likeliest(
    simulator: Simulator,
    problem: Problem,
    own_s: Mapping[str, float],
    plants: list[Plant],
    effect: Effect,
    shifts_s: FloatArray,
    noise: Noise,
) -> tuple[Plant, dict[str, float]]:
    """The one of `plants` under which readings are likeliest, and the moment of each recording under it.

    These moments are the likeliest that differ from `own_s` by one of the `shifts_s`.
    """
    usual_s = _usual(own_s)
    every = [_from(plant, effect, usual_s + float(shift_s)) for plant in plants for shift_s in shifts_s]
    fits = Fits(simulator, _begun(problem, own_s))
    costs = {
        name: each.reshape(len(plants), shifts_s.size)
        for name, each in fits.costs_of_each(every, noise).items()
    }
    best = int(np.argmin(sum(each.min(axis=1) for each in costs.values())))
    moved_s = {name: own_s[name] + float(shifts_s[np.argmin(each[best])]) for name, each in costs.items()}
    return plants[best], {name: max(moment_s, 0.0) for name, moment_s in moved_s.items()}


def _begun(problem: Problem, own_s: Mapping[str, float]) -> Problem:
    """`problem` with recordings begun so that the moments `own_s`, s of each, are one of the session, their median.

    A recording that nobody has seen may have any of them.
    """
    usual_s = _usual(own_s)
    return setting_in(problem, {name: usual_s - own for name, own in own_s.items()}, usual_s)


def _usual(own_s: Mapping[str, float]) -> float:
    """The middle one of the moments, s."""
    return sorted(own_s.values())[len(own_s) // 2]


def _sized(fits: Fits, plant: Plant, effect: Effect) -> list[Plant]:
    """`plant` with `effect` as it has it, and in several sizes.

    The larger these, the lighter the body beside them: a fit without the effect has spread its inertia over all time.
    """
    there = [plant] if effect.id in plant.active else []
    bare = simpler(plant, effect.id, fits.problem.plant) if there else plant
    inertias = {one.symbol for one in effect.parameters if one.dimension == INERTIA}
    starts = {
        tuple(sorted((symbol, value) for symbol, value in start.items() if symbol not in _moments(effect)))
        for start in fits.starts(effect)
    }
    body = bare.values[_BODY]
    return there + [
        bare.with_effect(
            effect.id,
            {symbol: 2.0 * (1.0 - left) * body if symbol in inertias else value for symbol, value in start}
            | dict.fromkeys(_moments(effect), NEVER_S),
        ).with_values({_BODY: left * body})
        for start, left in itertools.product(sorted(starts), _BODIES)
    ]


def _moments(effect: Effect) -> set[str]:
    return {one.symbol for one in effect.parameters if one.name in ("onset_s", "removed_s")}


def _from(plant: Plant, effect: Effect, moment_s: float) -> Plant:
    """`plant` whose `effect` acts from that moment of the session on, and stays."""
    return removed_at(at_onset(plant, effect, moment_s), effect, NEVER_S)


def _with_onset(problem: Problem, before: Structure) -> list[Effect]:
    """The effects with an onset that `before` has or could have."""
    there = [effect for effect in before.plant.effects if has_onset(effect)]
    could = [effect for effect in addable_effects(before.plant, problem.signals[0]) if has_onset(effect)]
    return [effect for effect in (*there, *could) if effect.id not in problem.without]
