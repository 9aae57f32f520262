"""A lag that wanders by more than one wave: a second one, where the first has been settled."""

from __future__ import annotations

from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.search.drafts import SLOW_ITERATIONS, START_ITERATIONS
from nxt_twin.diagnose.search.limits import EFFORT, LIMITS
from nxt_twin.diagnose.search.settled import Settled
from nxt_twin.physics.effect import Effect


def with_second_wave(fits: Fits, settled: Settled, trial: Structure, effect: Effect) -> Structure:
    """`trial` with a second wave of the lag that `effect` is, where that gains enough; else `trial`.

    The residuals show one only once the first wave has left them: beside none, the larger wave hides the other.
    """
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
