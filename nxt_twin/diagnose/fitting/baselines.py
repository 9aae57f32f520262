"""The plant that was given: settled, as it came, and re-fitted at its best."""

from __future__ import annotations

from dataclasses import replace

from nxt_twin.diagnose.fitting.everything import roughly_everything
from nxt_twin.diagnose.fitting.fitter import SETTLED, Fitter
from nxt_twin.diagnose.fitting.noise import first_noise
from nxt_twin.diagnose.fitting.settling import settled
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant

_AS_IT_STANDS = replace(SETTLED, iterations=0)


def settled_baseline(fitter: Fitter) -> Structure:
    """The problem's own plant, fitted and settled from a first guess of the noise."""
    problem = fitter.problem
    noise = first_noise(problem.plant, problem.signals, problem.scale.torque)
    return settled(fitter, problem.plant, noise)


def standing(fitter: Fitter, plant: Plant, noise: Noise) -> Structure:
    """`plant` with its parameters as they are."""
    return fitter.checked(fitter.fit(plant, noise, _AS_IT_STANDS)[0], noise)


def best_baseline(fitter: Fitter, baseline: Structure, final: Structure) -> Structure:
    """The re-fitted baseline that simulates best, so that what was found is not held against a straw man.

    It is fitted under its own noise, under that of the improved plant, and on simulation alone; the parameters as they
    were given stand beside.
    """
    simulating, drifting = fitter.simulating(baseline.plant, baseline.noise, everything=True)
    fits = [
        roughly_everything(fitter, baseline.plant, baseline.noise, rounds=2),
        roughly_everything(fitter, fitter.problem.plant, final.noise, rounds=0),
        fitter.checked(simulating, drifting),
        standing(fitter, fitter.problem.plant, baseline.noise),
    ]
    return min(fits, key=lambda one: fitter.simulated_error(one.plant, final.noise))
