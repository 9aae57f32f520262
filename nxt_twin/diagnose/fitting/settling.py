"""A plant under the noise that suits it best: noise and parameters in turn until both rest."""

from __future__ import annotations

import numpy as np

from nxt_twin.diagnose.fitting.fit import Fitted
from nxt_twin.diagnose.fitting.fitter import SETTLED, Fitter
from nxt_twin.diagnose.fitting.noise import estimate
from nxt_twin.diagnose.fitting.structure import DRAFT_STEP_S, Structure, step_for
from nxt_twin.diagnose.fitting.target import Target
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant

_ROUNDS = 4  # of noise and parameters in turn, at most
_RESTING_NATS = 1.0  # gain by a likelier noise at which it rests
_POLL_FACTORS = (0.5, 0.7, 0.85, 1.15, 1.4, 2.0)
_POLLED_NATS = 1.0  # gain from which a polled plant is worth another fit


def settled(fitter: Fitter, plant: Plant, noise: Noise) -> Structure:
    """`plant` under the noise that suits it best, both searched from what is given."""
    coarse_s = step_for(plant, DRAFT_STEP_S)  # a likelihood that is flat at its best needs no finer steps
    target = fitter.target(coarse_s)
    plant, noise = _begun(fitter, plant, noise, coarse_s)
    fitted, slopes = fitter.fit(plant, noise)
    noise_rests = False
    for _ in range(_ROUNDS):
        plant, other, gain = fitted.plant, noise, 0.0
        if not noise_rests:
            likelier, gain = estimate(fitter.simulator, plant, target, noise, near=True)
            noise_rests = gain < _RESTING_NATS
        if noise_rests:
            plant, gain = _polled(fitter, fitter.tuned(noise, coarse_s), fitted)
            if gain < _POLLED_NATS:
                break
        else:
            other = likelier
        again, slopes = fitter.fit(plant, other, SETTLED, slopes)
        if again.cost + again.prior_cost < fitted.cost + fitted.prior_cost:
            fitted, noise = again, other
        elif noise_rests:
            break
        else:  # what looked likelier by coarse steps is not by these
            noise_rests = True
    return fitter.checked(fitted, noise)


def _begun(fitter: Fitter, plant: Plant, noise: Noise, step_s: float) -> tuple[Plant, Noise]:
    """Where to settle from: `plant` as it stands, or fitted on simulation alone from two starts: the likeliest.

    Under an unknown torque that grows as it likes, single readings forgive parameters that do not simulate. Windows of
    simulation bring these into reach first; an onset or a period they may lose. The second start has the parameters of
    the baseline as they were given: without an effect that is missing, a re-fit may have moved them far away.
    """
    given = fitter.problem.plant.values
    afresh = plant.with_values({slot: value for slot, value in given.items() if slot in plant.values})
    fits = fitter.simulator.abreast(lambda start: fitter.simulating(start, noise), (plant, afresh))
    starts = [plant, *(fitted.plant for fitted, _ in fits)]
    drifting = min(fits, key=lambda fit: fit[1].drift)
    settled_noise, _ = estimate(fitter.simulator, drifting[0].plant, fitter.target(step_s), drifting[1])
    costs = fitter.tuned(settled_noise, step_s).pulling().costs_of(fitter.simulator, starts)
    return starts[int(np.argmin(costs))], settled_noise


def _polled(fitter: Fitter, tuned: Target, fitted: Fitted) -> tuple[Plant, float]:
    """The best of a few plants with one parameter of an effect well away, and its gain, nats.

    Play, stops and thresholds have likelihoods with steps in them, at which a slope leads nowhere.
    """
    plants = [
        _with_total_inertia(fitted.plant, slot, polled)
        for variable in fitted.variables
        for slot in variable.slots[:1]
        if slot not in fitter.problem.plant.values
        for polled in (variable.times(fitted.plant.values[slot], factor) for factor in _POLL_FACTORS)
        if variable.lower <= polled <= variable.upper
    ]
    if not plants:
        return fitted.plant, 0.0
    costs = tuned.costs_of(fitter.simulator, [*plants, fitted.plant])
    best = int(np.argmin(costs[:-1]))
    gain = float(costs[-1] - costs[best])
    return (plants[best], gain) if gain > _POLLED_NATS else (fitted.plant, 0.0)


def _with_total_inertia(plant: Plant, slot: Slot, value: float) -> Plant:
    """One parameter at another `value`; where it is a load's inertia, the body makes up for it."""
    more = value - plant.values[slot]
    new = {slot: value}
    body = Slot(BASE_OWNER, "inertia")
    if slot.symbol == "load_inertia" and plant.values[body] > more:
        new[body] = plant.values[body] - more
    return plant.with_values(new)
