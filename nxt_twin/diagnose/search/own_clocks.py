"""A clock that wanders, and stands elsewhere as each recording begins: tried where one course explains nothing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.own_moments import lengths_s, with_clocks
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.search.begun import Begun, bases, likeliest_begun
from nxt_twin.diagnose.search.explain import Explanation
from nxt_twin.diagnose.search.limits import EFFORT
from nxt_twin.diagnose.search.trials import addable_effects
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Simulator

_PHASES: Final = 36  # of a whole period, of the first look at each recording
_FINER: Final = 5  # between two of these, of the others
_ROUNDS: Final = 2  # of these
_PERIODS: Final = 1.0 + np.linspace(-0.02, 0.02, 5)  # factors, tried beside these
_AS_IT_IS: Final = np.ones(1)
_SETTLED: Final = 3  # of the likeliest waves


def with_own_clocks(simulator: Simulator, problem: Problem, explanation: Explanation) -> Begun | None:
    """`problem` with where a wandering clock stands as each recording begins, and a plant with it.

    None where readings are not likelier by far with it than with all that was found.
    """
    looks = [
        look
        for before in bases(explanation)
        for effect in addable_effects(before.plant, problem.signals[0])
        if "pace" in effect.terms and effect.id not in problem.without
        for look in _looks(simulator, problem, before, effect)
    ]
    return likeliest_begun(simulator, problem, explanation.best, looks)


def _looks(simulator: Simulator, problem: Problem, before: Structure, effect: Effect) -> list[Begun]:
    """`before` with a clock that wanders, `effect`, and the problem with where it stands as each recording begins.

    None where residuals suggest no wave. Under a small unknown torque, as a large one hides where a clock leaps.
    """
    at_zero = dict.fromkeys(lengths_s(problem), 0.0)
    sober = replace(before.noise, disturbance_std=EFFORT.sober * before.noise.disturbance_std)
    fits = Fits(simulator, with_clocks(problem, at_zero))
    begun = fits.abreast(
        lambda start: _settled(simulator, problem, at_zero, *start, effect, sober),
        fits.wandering_apart(fits.standing(before.plant, sober), effect)[:_SETTLED],
    )
    if not begun:
        return []
    likeliest = min(begun, key=lambda one: one[1].fitted_cost + one[1].check_cost)
    clock_s, structure = _placed(simulator, problem, *likeliest, effect)
    return [Begun(with_clocks(problem, clock_s), structure, effect)]


def _settled(
    simulator: Simulator,
    problem: Problem,
    at_zero: Mapping[str, float],
    plant: Plant,
    phases: Mapping[str, float],
    effect: Effect,
    noise: Noise,
) -> tuple[Mapping[str, float], Structure]:
    """`plant` settled with a wave that has these `phases`, and where its clock stands as each recording begins."""
    period_s = _value(plant, effect, "lag_period")
    clock_s = {name: phases.get(name, 0.0) * period_s for name in at_zero}
    fits = Fits(simulator, with_clocks(problem, clock_s))
    return clock_s, fits.settled(_with(plant, effect, "lag_phase", 0.0), noise)


def _placed(
    simulator: Simulator,
    problem: Problem,
    clock_s: Mapping[str, float],
    structure: Structure,
    effect: Effect,
) -> tuple[Mapping[str, float], Structure]:
    """Where the clock of `structure` stands in each recording, that are held out too, looked for ever more finely.

    Periods are tried with it: where a clock leaps, a likelihood has steps, and no slope leads to the right one.
    """
    everywhere = np.arange(_PHASES) / _PHASES - 0.5
    nearby = np.linspace(-1.0, 1.0, 2 * _FINER + 1) / _PHASES
    for phases, periods in ((everywhere, _AS_IT_IS), *[(nearby, _PERIODS)] * _ROUNDS):
        plant, clock_s = _likeliest(simulator, problem, clock_s, structure, effect, (phases, periods))
        fits = Fits(simulator, with_clocks(problem, clock_s))
        structure = fits.settled(_with(plant, effect, "lag_phase", 0.0), structure.noise)
    return clock_s, structure


def _likeliest(
    simulator: Simulator,
    problem: Problem,
    clock_s: Mapping[str, float],
    structure: Structure,
    effect: Effect,
    tried: tuple[FloatArray, FloatArray],
) -> tuple[Plant, dict[str, float]]:
    """The plant with the likeliest period, and `clock_s` of each recording moved by its likeliest phase under it.

    `tried` are phases beyond that of the plant, and factors of its period.
    """
    phases = _value(structure.plant, effect, "lag_phase") + tried[0]
    periods_s = _value(structure.plant, effect, "lag_period") * tried[1]
    slower = [_with(structure.plant, effect, "lag_period", float(period_s)) for period_s in periods_s]
    every = [_with(plant, effect, "lag_phase", float(phase)) for plant in slower for phase in phases]
    costs = {
        name: each.reshape(periods_s.size, phases.size)
        for name, each in Fits(simulator, with_clocks(problem, clock_s))
        .costs_of_each(every, structure.noise)
        .items()
    }
    best = int(np.argmin(sum(each.min(axis=1) for each in costs.values())))
    moved_s = {
        name: clock_s[name] + float(periods_s[best] * phases[np.argmin(each[best])])
        for name, each in costs.items()
    }
    return slower[best], moved_s


def _value(plant: Plant, effect: Effect, symbol: str) -> float:
    return plant.values[Slot(effect.id, symbol)]


def _with(plant: Plant, effect: Effect, symbol: str, value: float) -> Plant:
    return plant.with_values({Slot(effect.id, symbol): value})
