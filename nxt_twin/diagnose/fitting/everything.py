"""A plant fitted on every reading that is not held out, under the noise that suits it."""

from __future__ import annotations

from dataclasses import replace

from nxt_twin.diagnose.fitting.fitter import EXACT, SETTLED, Fitter
from nxt_twin.diagnose.fitting.noise import estimate, with_noise
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant

_WHILE_NOISE_SETTLES = replace(SETTLED, iterations=15)
_AS_IT_STANDS = replace(EXACT, iterations=0)
_AS_GOOD = 1.25  # of the simulated error over all that is fitted
_LAST = replace(SETTLED, iterations=25)


def fit_everything(fitter: Fitter, plant: Plant, noise: Noise) -> Structure:
    """Fit `plant` on target and check together, under the noise that suits it, to the last digit."""
    near = roughly_everything(fitter, plant, noise, rounds=2)
    tuned = with_noise(fitter.problem.objective.everything(), near.noise)
    fitted, _ = fitter.fit_on(tuned, near.plant, EXACT)
    if fitter.problem.by_windows:
        return fitter.checked(fitted, near.noise, EXACT)
    likeliest = _likeliest(fitter, near)
    errors = [fitter.simulated_error(one, near.noise) for one in (likeliest, fitted.plant)]
    if errors[0] <= _AS_GOOD * errors[1]:
        fitted, _ = fitter.fit_on(tuned, likeliest, _AS_IT_STANDS)
    return fitter.checked(fitted, near.noise, EXACT)


def _likeliest(fitter: Fitter, near: Structure) -> Plant:
    """The plant under which single readings are likeliest.

    Where it simulates as well as one that was fitted to simulate, it is the better estimate: what is simulated errs
    together over a whole window, and a few windows say little.
    """
    single = with_noise(fitter.problem.target.everything(), near.noise)
    return fitter.fit_on(single, near.plant, replace(EXACT, covariance=False))[0].plant


def roughly_everything(fitter: Fitter, plant: Plant, noise: Noise, *, rounds: int) -> Structure:
    """Fit `plant` on target and check together, as closely as a structure is weighed.

    Noise and parameters are estimated in turn for a number of `rounds`; without a round, `noise` stays as it is. No
    fitter fits one plant so twice.
    """
    key = (id(plant), noise, rounds)
    if key not in fitter.on_everything:
        fitter.on_everything[key] = (plant, _roughly(fitter, plant, noise, rounds))
    return fitter.on_everything[key][1]


def _roughly(fitter: Fitter, plant: Plant, noise: Noise, rounds: int) -> Structure:
    target = fitter.problem.objective.everything().with_step(SETTLED.step_for(plant))
    for _ in range(rounds):
        plant = fitter.fit_on(with_noise(target, noise), plant, _WHILE_NOISE_SETTLES)[0].plant
        noise, _ = estimate(fitter.simulator, plant, target, noise)
    return fitter.checked(fitter.fit_on(with_noise(target, noise), plant, _LAST)[0], noise)
