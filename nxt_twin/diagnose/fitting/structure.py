"""Structures - sets of effects - fitted, and what the readings that only check say of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.fit import Fitted
from nxt_twin.diagnose.fitting.free_run import error_ratio, mean_error
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import STEP_S

DRAFT_STEP_S = 4e-3  # of a simulation that only ranks a candidate
SETTLED_STEP_S = 2e-3
"""Steps while structures are searched and weighed; what is reported is fitted with `STEP_S`. For an NXT motor they err
by less than 5 and 1 nats; an effect with a mechanical state of its own takes half of either."""

_MECHANICAL = {"torque", "damping", "friction", "hold"}


@final
@dataclass(frozen=True)
class Structure:
    """A plant with its parameters and noise fitted.

    Attributes:
        fitted: the fit on the target's readings.
        noise: under which it was fitted.
        check_cost: negative log-likelihood of the readings that only check, nats.
        window_errors: RMS error of each window over the check readings, SI. The first array is for free runs
            that start anew in each window, the second for one free run over each recording; shape (windows,).
        believed: how many of those readings were taken for readings rather than for faults.
        slight: error of a window, SI, below which it says nothing: rounding alone leaves as much.
    """

    fitted: Fitted
    noise: Noise
    check_cost: float
    window_errors: tuple[FloatArray, FloatArray]
    believed: int
    slight: float = 0.0

    @property
    def plant(self) -> Plant:
        """The fitted plant."""
        return self.fitted.plant

    @property
    def free_run_rms(self) -> tuple[float, float]:
        """The means of both kinds of `window_errors`, SI."""
        anew, whole = self.window_errors
        return mean_error(anew), mean_error(whole)

    @property
    def fitted_cost(self) -> float:
        """Of the readings that were fitted and of the priors, nats."""
        return self.fitted.cost + self.fitted.prior_cost


@final
@dataclass(frozen=True)
class Draft:
    """A plant fitted roughly, and the cost of the checking readings under the same noise, nats."""

    fitted: Fitted
    check_cost: float

    @property
    def cost(self) -> float:
        """Of all readings and priors, nats."""
        return self.fitted.cost + self.fitted.prior_cost + self.check_cost


def step_for(plant: Plant, coarse_s: float) -> float:
    """`coarse_s`, or half of it where an effect has a mechanical state of its own, which may be stiff."""
    stiff = any(is_mechanical(effect) for effect in plant.effects)
    return max(STEP_S, 0.5 * coarse_s) if stiff else coarse_s


def is_mechanical(effect: Effect) -> bool:
    """Whether the effect has a state of its own in the balance of torques, such as a load behind play."""
    return bool(effect.states and _MECHANICAL & effect.terms.keys())


def shares(plant: Plant) -> int:
    """How many shares of faulty readings `plant` has, which no fit counts among its variables."""
    return sum("outlier" in effect.terms for effect in plant.effects)


def free_run_ratios(simpler: Structure, richer: Structure) -> tuple[float, float]:
    """Errors of `richer` in free runs over those of `simpler`, by the kinder of two ways to run and by the other."""
    pairs = zip(simpler.window_errors, richer.window_errors, strict=True)
    kind, unkind = sorted(error_ratio(before, after, simpler.slight) for before, after in pairs)
    return kind, unkind


def free_run_growth(simpler: Structure, richer: Structure) -> float:
    """By how much the mean error of free runs grows to `richer`, in the kinder of two ways to run, SI."""
    pairs = zip(simpler.window_errors, richer.window_errors, strict=True)
    return min(mean_error(after) - mean_error(before) for before, after in pairs)
