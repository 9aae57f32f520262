"""The errors that the true structure reaches on a case: the measure of whether a search could find it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from nxt_twin.blind.reached import Reach
from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting.baselines import settled_baseline
from nxt_twin.diagnose.fitting.everything import fit_everything
from nxt_twin.diagnose.fitting.fitter import SETTLED, Fitter
from nxt_twin.diagnose.fitting.noise import with_noise
from nxt_twin.diagnose.fitting.settling import settled
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.fitting.variables import starts_of
from nxt_twin.diagnose.judging.horizons import errors_of
from nxt_twin.diagnose.judging.judge import free_runs, overall
from nxt_twin.diagnose.search.settled import simpler
from nxt_twin.diagnose.search.sharing import UNDER_ITS_OWN, UNDER_MORE
from nxt_twin.diagnose.search.weight import weigh
from nxt_twin.diagnose.units import units_of
from nxt_twin.physics.layout import Layout
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.case import Case

_SHARES = (*UNDER_ITS_OWN, UNDER_MORE)
_LIKELIER_NATS = 1.0  # by which another start has to be likelier to count


def reach(case: Case, answer: Mapping[str, Any]) -> Reach | None:
    """Fit the true structure to a case; None where the library does not hold all that is hidden."""
    problem = problem_for(case)
    effects = answer["effects"]
    if not _holds(problem.plant.layout, effects):
        return None
    with Simulator(problem.plant.layout) as simulator:
        fitter = Fitter(simulator, problem)
        baseline = settled_baseline(fitter)
        true = likelier(_with_effects(fitter, baseline, effects), _from_the_truth(fitter, baseline, answer))
        weight = weigh(baseline, true)
        final = fit_everything(fitter, true.plant, true.noise)
        factor = units_of(problem.plant.layout.frame, problem.signals[0]).reading_factor
        runs = free_runs(simulator, problem, final.plant, final.plant, final.noise)
        errors = errors_of(simulator, problem, final.plant, final.plant, final.noise)
        horizons = {seconds: rms * factor for seconds, rms in zip(errors.seconds, errors.rms, strict=True)}
        each = _each_gain(fitter, baseline, true, effects) if len(effects) > 1 else {}
        return Reach(weight.gain, weight.check_gain, overall(runs) * factor, horizons, each)


def likelier(usual: Structure, other: Structure) -> Structure:
    """`other` if it is likelier on what was fitted, by more than chance."""
    return other if other.fitted_cost < usual.fitted_cost - _LIKELIER_NATS else usual


def _with_effects(fitter: Fitter, baseline: Structure, effects: Sequence[Mapping[str, Any]]) -> Structure:
    """`baseline` with the hidden effects, one after the other, each settled from its true size."""
    true = baseline
    for effect in effects:
        started = _started(fitter, true.plant, effect, true.noise)
        fitted, _ = fitter.fit(started, true.noise, replace(SETTLED, iterations=25))
        true = settled(fitter, fitted.plant, true.noise)
    return true


def _from_the_truth(fitter: Fitter, baseline: Structure, answer: Mapping[str, Any]) -> Structure:
    """The true structure settled from its true numbers: from those of a re-fitted baseline it may not find there."""
    parameters = baseline.plant.layout.parameters
    fitted = [slot for variable in baseline.fitted.variables for slot in variable.slots]
    known = {
        slot: answer["base"][parameters[slot].name] * parameters[slot].si
        for slot in fitted
        if parameters[slot].name in answer["base"]
    }
    plant = baseline.plant.with_values(known)
    for effect in answer["effects"]:
        plant = _started(fitter, plant, effect, baseline.noise)
    return settled(fitter, plant, baseline.noise)


def _each_gain(
    fitter: Fitter, baseline: Structure, true: Structure, effects: Sequence[Mapping[str, Any]]
) -> dict[str, float]:
    """What each hidden effect gains beside the others, nats: `true` against the best fit of the others alone.

    The others are fitted from where `true` lies, and from the baseline. Both may rest in a worse place.
    """
    gains = {}
    for effect in effects:
        others = [other for other in effects if other is not effect]
        plant = simpler(true.plant, effect["id"], fitter.problem.plant)
        lesser = [settled(fitter, plant, true.noise), _with_effects(fitter, baseline, others)]
        gains[effect["id"]] = min(weigh(one, true).gain for one in lesser)
    return gains


def _holds(layout: Layout, effects: list[Mapping[str, Any]]) -> bool:
    return {effect["id"] for effect in effects} <= {effect.id for effect in layout.effects}


def _started(fitter: Fitter, plant: Plant, hidden: Mapping[str, Any], noise: Noise) -> Plant:
    """`plant` with the hidden effect at its true size; what the answer does not tell is tried."""
    effect = plant.layout.effect(hidden["id"])
    known = {
        parameter.symbol: hidden["params"][parameter.name] * parameter.si
        for parameter in effect.parameters
        if parameter.name in hidden["params"]
    }
    trials = [
        plant.with_effect(effect.id, {**start, **known}) for start in _distinct(fitter, effect.id, known)
    ]
    vectors = [trial.vectors() for trial in trials]
    target = with_noise(fitter.problem.target, noise)
    values, active = (np.array(column) for column in zip(*vectors, strict=True))
    costs = target.cost(fitter.simulator.run(values, active, target.jobs))
    return trials[int(np.argmin(costs))]


def _distinct(fitter: Fitter, effect_id: str, known: Mapping[str, float]) -> list[dict[str, float]]:
    """Starting values that differ in something that is not known."""
    effect = fitter.problem.plant.layout.effect(effect_id)
    shares = [each.symbol for each in effect.parameters if each.shared_out]
    different = {}
    for start in starts_of(effect, fitter.problem.scale):
        for share in _SHARES if shares else (0.0,):
            one = {**start, **dict.fromkeys(shares, share)}
            free = {symbol: value for symbol, value in one.items() if symbol not in known}
            different[tuple(sorted(free.items()))] = free
    return list(different.values())
