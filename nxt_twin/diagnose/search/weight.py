"""What speaks for one structure over a simpler one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

from nxt_twin.diagnose.fitting.structure import (
    Structure,
    free_run_growth,
    free_run_ratios,
    is_mechanical,
    shares,
)

FREE_RUN_RATIO = 1.01  # ratio of errors in free runs from which a structure has learnt noise
_DOUBTING_RATIO = 1.1  # doubt in readings moves what is fitted by little, while other physics may still lack
_SURE_RATIO = 1.05  # as `FREE_RUN_RATIO`, where checking readings are sure or given numbers come back
_SURE_NATS = 40.0  # so much likelier readings that were not fitted are no learnt noise
_HARDLY_MORE = (
    0.1  # of the error that says nothing: by so much free runs may get worse where checking readings are sure
)
_HIDDEN_RATIO = 1.15  # as `FREE_RUN_RATIO`, for a load behind play or a shaft, whose state a start lacks
_BORNE_OUT_NATS = 10.0  # nats on checking readings above which `_HIDDEN_RATIO` holds
_UNKIND_RATIO = 2.5  # as `FREE_RUN_RATIO`, in the less kind of two ways to run
_MUCH_NEARER = 0.5  # ratio of errors in free runs below which these outweigh a few readings
_DENIED_NATS = 3.0  # nats that checking readings may lose, where nearer runs or restored numbers bear it out
_DENIED_SHARE = 0.1  # of the gain: where more is missing, few readings may deny what all others call for
_AS_MANY = 0.97  # of the readings that the richer one believes: the simpler one dodges if it believes fewer
RESTORED_NATS = 10.0
"""What the priors of given numbers have to gain so that no unseen reading need bear it out.

A datasheet's numbers are no noise that a fit could learn. 10 nats are one number that was off by 4.5 of its standard
deviations. Set on foreign servos whose loop was limited to 45 %: 20 nats.
"""


@final
@dataclass(frozen=True)
class Weight:
    """What speaks for a structure over a simpler one, nats.

    Attributes:
        gain: in likelihood of the readings that were fitted, less the information criterion's penalty.
        check_gain: in likelihood of readings that were not.
        free_run_ratio: its error in free runs over that of the simpler one, in the kinder of two ways to run.
        runs_worse: whether free runs speak against the richer one: it predicts one step better and has learnt noise.
        restored_nats: what of `gain` the priors gain: without it, a re-fit took given numbers far from what they were.
    """

    gain: float
    check_gain: float
    free_run_ratio: float
    runs_worse: bool
    restored_nats: float = 0.0

    @property
    def restores(self) -> bool:
        """Whether given numbers come back with it that a re-fit had to move far, to move the plant alike."""
        return self.restored_nats > RESTORED_NATS

    @property
    def total(self) -> float:
        """The sum of both, by which candidates are ranked."""
        return self.gain + self.check_gain

    def borne_out(self, least_nats: float) -> bool:
        """Whether readings that were not fitted speak for the richer one: by likelihood, or by free runs over them.

        A few of them say little one by one, and free runs much nearer say more. What restores given numbers may move
        the plant just as the numbers did that were put in their place: no reading tells these two apart.
        """
        denied = max(_DENIED_NATS, _DENIED_SHARE * self.gain)
        either = self.free_run_ratio < _MUCH_NEARER or self.restores
        return self.check_gain > least_nats or (either and self.check_gain > -denied)


def weigh(simpler: Structure, richer: Structure) -> Weight:
    """What speaks for `richer` over `simpler`. Half a logarithm of the readings for each further parameter (BIC)."""
    further = len(richer.fitted.variables) - len(simpler.fitted.variables)
    further += shares(richer.plant) - shares(simpler.plant)
    penalty = 0.5 * further * math.log(max(richer.fitted.readings, 2))
    gain = simpler.fitted_cost - richer.fitted_cost
    check_gain = simpler.check_cost - richer.check_cost
    kind, unkind = free_run_ratios(simpler, richer)
    sure = check_gain > _SURE_NATS
    hidden = _adds_a_second_body(simpler, richer) and check_gain > _BORNE_OUT_NATS
    restored = simpler.fitted.prior_cost - richer.fitted.prior_cost
    least = max(_SURE_RATIO if sure or restored > RESTORED_NATS else 0.0, _HIDDEN_RATIO if hidden else 0.0)
    unkind_only = sure and kind < _MUCH_NEARER  # a start anew in the middle may lie on the edge of sticking
    return Weight(
        gain - penalty,
        check_gain,
        kind,
        runs_worse=(
            kind >= max(_most_ratio(simpler, richer), least) and not (sure and _is_as_near(simpler, richer))
        )
        or (unkind >= _UNKIND_RATIO and not unkind_only and not _dodges(simpler, richer)),
        restored_nats=restored,
    )


def _most_ratio(simpler: Structure, richer: Structure) -> float:
    """The ratio of errors in free runs from which they speak against the richer one."""
    if _dodges(simpler, richer):
        return math.inf
    added = [effect for effect in richer.plant.effects if effect.id not in simpler.plant.active]
    doubting = bool(added) and all("outlier" in effect.terms for effect in added)
    return _DOUBTING_RATIO if doubting else FREE_RUN_RATIO


def _is_as_near(simpler: Structure, richer: Structure) -> bool:
    """Whether the mean error of either kind of free runs grows by next to nothing of what matters."""
    return free_run_growth(simpler, richer) < _HARDLY_MORE * simpler.slight


def _adds_a_second_body(simpler: Structure, richer: Structure) -> bool:
    """Whether the richer one has a body whose place a start anew cannot know."""
    added = [effect for effect in richer.plant.effects if effect.id not in simpler.plant.active]
    return any(is_mechanical(effect) for effect in added)


def _dodges(simpler: Structure, richer: Structure) -> bool:
    """Whether the simpler one takes for faults what it cannot explain, so that its free runs tell nothing."""
    return simpler.believed < _AS_MANY * richer.believed


def free_run_ratio(simpler: Structure, richer: Structure) -> float:
    """The error of `richer` in free runs over that of `simpler`, in the kinder of the two ways to run.

    A start anew cannot know the state of a load behind play or a shaft; a whole run of an integrator drifts.
    """
    return free_run_ratios(simpler, richer)[0]
