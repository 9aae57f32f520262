"""A plant fitted on every reading that is not held out, under the noise that suits it."""

from __future__ import annotations

from dataclasses import replace

from nxt_twin.diagnose.fitting.fitter import EXACT, SETTLED, Fitter
from nxt_twin.diagnose.fitting.noise import estimate, with_noise
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant

_WHILE_NOISE_SETTLES = replace(SETTLED, iterations=15)
_LAST = replace(SETTLED, iterations=25)


def fit_everything(fitter: Fitter, plant: Plant, noise: Noise) -> Structure:
    """Fit `plant` on target and check together, under the noise that suits it, to the last digit."""
    near = roughly_everything(fitter, plant, noise, rounds=2)
    tuned = with_noise(fitter.problem.objective.everything(), near.noise)
    return fitter.checked(fitter.fit_on(tuned, near.plant, EXACT)[0], near.noise, EXACT)


def roughly_everything(fitter: Fitter, plant: Plant, noise: Noise, *, rounds: int) -> Structure:
    """Fit `plant` on target and check together, as closely as a structure is weighed.

    Noise and parameters are estimated in turn for so many `rounds`; without a round, `noise` stays as it is.
    """
    target = fitter.problem.objective.everything().with_step(SETTLED.step_for(plant))
    for _ in range(rounds):
        plant = fitter.fit_on(with_noise(target, noise), plant, _WHILE_NOISE_SETTLES)[0].plant
        noise, _ = estimate(fitter.simulator, plant, target, noise)
    return fitter.checked(fitter.fit_on(with_noise(target, noise), plant, _LAST)[0], noise)
