"""Plants fitted roughly, and plants weighed as they stand: enough to rank them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.fitter import DRAFTED, Fitter
from nxt_twin.diagnose.fitting.noise import with_noise
from nxt_twin.diagnose.fitting.own_moments import recordings_of
from nxt_twin.diagnose.fitting.problem import target_of
from nxt_twin.diagnose.fitting.splits import Split
from nxt_twin.diagnose.fitting.structure import Draft
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant


def drafted(fitter: Fitter, plant: Plant, noise: Noise, *, iterations: int) -> Draft:
    """Fit `plant` roughly under `noise`, on coarse steps."""
    effort = replace(DRAFTED, iterations=iterations)
    fitted, _ = fitter.fit(plant, noise, effort)
    return Draft(fitted, draft_cost(fitter, fitted.plant, noise, effort.step_for(plant))[1])


def draft_cost(fitter: Fitter, plant: Plant, noise: Noise, step_s: float) -> tuple[float, float]:
    """Cost of `plant` as it stands on the target's readings and on the checking ones, steps of `step_s`."""
    values, active = plant.vectors()
    target = fitter.tuned(noise, step_s).telling()
    results = fitter.simulator.run(values[None], active[None], target.jobs)
    checking = target.checking()
    return float(target.cost(results)[0]), float(checking.cost(results)[0])


def draft_costs(fitter: Fitter, plants: Sequence[Plant], noise: Noise) -> FloatArray:
    """Costs of plants with the same effects as they stand, on the target's readings, by the steps of a draft."""
    return fitter.tuned(noise, DRAFTED.step_for(plants[0])).costs_of(fitter.simulator, plants)


def check_costs(fitter: Fitter, plants: Sequence[Plant], noise: Noise) -> FloatArray:
    """As `draft_costs`, on the checking readings."""
    checking = fitter.tuned(noise, DRAFTED.step_for(plants[0])).checking()
    return checking.costs_of(fitter.simulator, plants)


def costs_everywhere(fitter: Fitter, plants: Sequence[Plant], noise: Noise) -> FloatArray:
    """As `draft_costs`, on target and checking readings together."""
    return fitter.tuned(noise, DRAFTED.step_for(plants[0])).everything().costs_of(fitter.simulator, plants)


def costs_of_each(fitter: Fitter, plants: Sequence[Plant], noise: Noise) -> dict[str, FloatArray]:
    """Costs of the readings of each recording under plants with equal effects, nats, shape (plants,), by name.

    Of a recording that is held out as a whole, all readings count: it has a moment of its own, too.
    """
    step_s = DRAFTED.step_for(plants[0])
    names = {one.name for one in fitter.problem.signals}
    apart = [one for one in recordings_of(fitter.problem) if one.name not in names]
    fitted = fitter.tuned(noise, step_s).telling().everything()
    targets = [fitted.only(name) for name in sorted(names)]
    for one in apart:
        nothing = np.zeros(one.time_s.size, dtype=bool)
        told = target_of(fitter.problem.plant, [one], [Split(nothing, nothing)])
        targets.append(with_noise(told, noise).with_step(step_s))
    return {target.jobs[0].signals.name: target.costs_of(fitter.simulator, plants) for target in targets}
