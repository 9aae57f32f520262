"""A lag that wanders by more than one wave: a second one, where the first has been settled."""

from __future__ import annotations

from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.search.drafts import SLOW_ITERATIONS, START_ITERATIONS
from nxt_twin.diagnose.search.limits import EFFORT, LIMITS
from nxt_twin.diagnose.search.settled import Settled
from nxt_twin.physics.effect import Effect

_EXCHANGES = 2  # first waves at most that leave for another one


def with_second_wave(fits: Fits, settled: Settled, trial: Structure, effect: Effect) -> Structure:
    """`trial` with a second wave of the lag that `effect` is, where that gains enough; else `trial`.

    The residuals show one only once the first wave has left them: beside none, the larger wave hides the other. Where
    the second is large, the first may be no wave at all: it leaves, and another is looked for.
    """
    best = _with_second_wave(fits, settled, trial, effect)
    for _ in range(_EXCHANGES):
        alone = fits.second_wave_alone(best.plant, effect)
        if alone is None:
            break
        other = _with_second_wave(fits, settled, fits.settled(alone, trial.noise), effect)
        if other.fitted_cost > best.fitted_cost - EFFORT.better_nats:
            break
        best = other
    return best


def _with_second_wave(fits: Fits, settled: Settled, trial: Structure, effect: Effect) -> Structure:
    least = EFFORT.second_promised * LIMITS.second_nats
    plants = [plant for gain, plant in fits.second_waves(trial, effect) if gain > least]
    if not plants:
        return trial
    begun = [fits.draft(plant, trial.noise, iterations=START_ITERATIONS) for plant in plants]
    leading = min(begun, key=lambda made: made.cost)
    draft = fits.draft(leading.fitted.plant, trial.noise, iterations=SLOW_ITERATIONS)
    if fits.drafted_cost(trial, trial.noise) - draft.cost < LIMITS.second_nats:
        return trial
    return settled.settle(draft.fitted.plant, trial.noise)
