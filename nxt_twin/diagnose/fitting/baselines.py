"""The plant that was given: settled, as it came, and re-fitted at its best."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.everything import roughly_everything
from nxt_twin.diagnose.fitting.fitter import SETTLED, Fitter
from nxt_twin.diagnose.fitting.free_windows import fitted_freely
from nxt_twin.diagnose.fitting.noise import estimate, first_noise, with_noise
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.settling import settled
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant

CLEARLY_NEARER = 0.95
"""Share of a plain fit's errors at each horizon, below which another fit of the baseline replaces it.

Set on motors with play or a twisting shaft of all truth families, seeds 21 to 25. Where nothing was found, it is the
share of a likely fit's error in windows below which a plain fit replaces that one. Of 303 clean motors and 104 with
unknown effects of the spent range `thirteenth`, shares of 0.9 to 0.98 did equally well.
"""

AS_GOOD = 1.05
"""That share where windows of simulation are off by less than the tolerance."""

ORDINARY = 0.35
"""Share of the mean error of a simulation that a plain fit takes for a standard deviation; set on those motors, too.

Errors beyond twice that count in proportion, so that a window on the edge of sticking does not outweigh all others.
"""

READINGS_OF_A_WINDOW = 4.0
"""As how many independent readings a window of simulation counts against the priors of given numbers."""

DEAR_NATS = 10.0
"""What the priors of given numbers cost a plain fit at least, above another one, where the other is to replace it."""

_PLAIN_ROUNDS = 2  # of a plain fit: the loss follows the error that the last one left
_LEAST_ERROR = 1e-12  # of a plant that sticks fast as the motor does, none is left
_WINDOWS = 1  # which of the errors that a fitter gives is that of windows
_AS_IT_STANDS = replace(SETTLED, iterations=0)


def settled_baseline(fitter: Fitter) -> Structure:
    """The problem's own plant, fitted and settled from a first guess of the noise."""
    problem = fitter.problem
    noise = first_noise(problem.plant, problem.signals, problem.scale.torque)
    return settled(fitter, problem.plant, noise)


def standing(fitter: Fitter, plant: Plant, noise: Noise) -> Structure:
    """`plant` with its parameters as they are."""
    return fitter.checked(fitter.fit(plant, noise, _AS_IT_STANDS)[0], noise)


def likely_baseline(fitter: Fitter, baseline: Structure, final: Structure) -> Structure:
    """The re-fitted baseline where nothing was found: `final`, its likeliest fit, or a plain fit of windows.

    Of a model that lacks nothing, the fit that knows the noise is the better estimate. Where the plain fit simulates
    windows clearly nearer, the model lacks something that no effect stands for.
    """
    fits = [plainly_fitted(fitter, baseline, final.noise), final]
    errors = np.array([fitter.simulated_errors(one.plant, final.noise)[_WINDOWS] for one in fits])
    priors = np.array([one.fitted.prior_cost for one in fits])
    plain = is_plainly_nearer(priors, errors, windows_of(fitter.problem), fitter.problem.tolerance)
    return fits[0] if plain else final


def is_plainly_nearer(prior_nats: FloatArray, errors: FloatArray, windows: float, tolerance: float) -> bool:
    """Whether a plain fit replaces a likely one.

    Args:
        prior_nats: what both cost by the priors of given numbers, the plain one first, shape (2,).
        errors: of windows, SI, shape (2,).
        windows: how many windows were simulated.
        tolerance: the error that does not matter, SI.
    """
    logs = np.log(np.maximum(errors, max(tolerance, _LEAST_ERROR)))
    gained = float(logs[1] - logs[0])
    dearer = float(prior_nats[0] - prior_nats[1])
    paid = dearer <= DEAR_NATS or READINGS_OF_A_WINDOW * windows * gained > dearer
    return gained > -math.log(CLEARLY_NEARER) and paid


def best_baseline(fitter: Fitter, baseline: Structure, final: Structure) -> Structure:
    """The re-fitted baseline that simulates best, so that what was found beside it is not held against a straw man.

    It is a plain fit of windows. Fits under other noises and a fit on simulation alone replace it where `is_nearer`. So
    do the given parameters and those of the improved plant. The likeliest of them also does where its windows gain less
    than its priors cost. Physics that a model leaves out may look like a parameter a hundred times as large.
    """
    simulating, drifting = fitter.simulating(baseline.plant, baseline.noise, everything=True)
    given = fitter.problem.plant
    ways: list[Callable[[], Structure]] = [
        lambda: plainly_fitted(fitter, baseline, final.noise),
        lambda: roughly_everything(fitter, baseline.plant, baseline.noise, rounds=2),
        lambda: roughly_everything(fitter, given, final.noise, rounds=0),
        lambda: fitter.checked(simulating, drifting),
        lambda: standing(fitter, given, baseline.noise),
        lambda: standing(fitter, _bare(given, final.plant), baseline.noise),
    ]
    fits = fitter.simulator.abreast(lambda way: way(), ways)
    errors = np.array([fitter.simulated_errors(one.plant, final.noise) for one in fits])
    priors = np.array([one.fitted.prior_cost for one in fits])
    return fits[best_fit(priors, errors, windows_of(fitter.problem), fitter.problem.tolerance)]


def _bare(given: Plant, improved: Plant) -> Plant:
    """The `given` plant with the numbers that it has in an `improved` one: what that adds may show in a few moments."""
    return given.with_values(
        {slot: improved.values[slot] for slot in given.values if slot in improved.values}
    )


def best_fit(prior_nats: FloatArray, errors: FloatArray, windows: float, tolerance: float) -> int:
    """The number of the fit that is the baseline: 0, a plain one, or one that replaces it.

    Args:
        prior_nats: what each fit costs by the priors of given numbers, shape (fits,).
        errors: of short windows, windows and whole runs, SI, shape (fits, 3).
        windows: how many windows were simulated.
        tolerance: the error that does not matter, SI.
    """
    logs = np.log(np.maximum(errors, _LEAST_ERROR))
    nearer = [n for n in range(1, len(errors)) if is_nearer(errors[n], errors[0], tolerance)]
    if nearer:
        return min(nearer, key=lambda n: float(logs[n].sum()))
    # Errors within one window go on in one another, so that a window counts as a few readings against the priors.
    burdens = prior_nats + READINGS_OF_A_WINDOW * windows * logs[:, _WINDOWS]
    likeliest = int(np.argmin(burdens))
    return likeliest if prior_nats[0] - prior_nats[likeliest] > DEAR_NATS else 0


def is_nearer(errors: FloatArray, plain: FloatArray, tolerance: float) -> bool:
    """Whether a fit with these `simulated_errors` takes the place of a `plain` one.

    It has to be clearly better at each horizon, above what does not matter. Where windows do not matter, a fit that
    knows the noise is the better estimate, and its whole runs need only be as good.
    """
    silent = bool((errors[:-1] <= tolerance).all())
    return bool((errors <= np.maximum((AS_GOOD if silent else CLEARLY_NEARER) * plain, tolerance)).all())


def windows_of(problem: Problem) -> float:
    """How many windows of simulation the readings that are not held out fill."""
    held = {id(part.signals): part.counted for part in problem.held_out}
    seconds = [s.interval_s * (s.time_s.size - np.sum(held.get(id(s), False))) for s in problem.signals]
    return float(sum(seconds)) / problem.window_s


def plainly_fitted(fitter: Fitter, baseline: Structure, noise: Noise) -> Structure:
    """The baseline fitted to windows that run freely, from where it has settled, under the noise that suits it."""
    plant = baseline.plant
    for _ in range(_PLAIN_ROUNDS):
        plant = fitted_freely(fitter, plant, ORDINARY * fitter.simulated_error(plant, noise))
    target = fitter.problem.objective.everything().with_step(SETTLED.step_for(plant))
    own, _ = estimate(fitter.simulator, plant, target, baseline.noise)
    return fitter.checked(fitter.fit_on(with_noise(target, own), plant, _AS_IT_STANDS)[0], own)
