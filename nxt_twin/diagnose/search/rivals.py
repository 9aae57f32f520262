"""Effects that do nearly as well in the place of found ones."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.search.limits import LIMITS
from nxt_twin.diagnose.search.weight import free_run_ratio, weigh
from nxt_twin.physics.effect import Effect


@final
@dataclass(frozen=True)
class Rival:
    """An effect that does nearly as well in the place of a found one.

    Attributes:
        effect: the other.
        behind: nats, negative if it is likelier.
        structure: with it in the found one's place.
        simulates_worse: whether free runs over checking readings speak against it, or given numbers that are far off
            with it.
        is_twin: whether the two move a motor alike, at the sizes that they have.
    """

    effect: Effect
    behind: float
    structure: Structure
    simulates_worse: bool
    is_twin: bool = False

    @property
    def doubt_nats(self) -> float:
        """How far behind it counts when beliefs are shared: where likelihood and simulation disagree, a tie.

        What likelihood says of twins counts for no more than what speaks beforehand for one of them.
        """
        if self.is_twin and abs(self.behind) < LIMITS.twin_nats:
            return min(max(self.behind, -LIMITS.coincidence_nats), LIMITS.coincidence_nats)
        return max(self.behind, 0.0) if self.simulates_worse else self.behind


def likelier_structure(rivals: dict[str, tuple[Rival, ...]]) -> Structure | None:
    """The structure with one effect exchanged that is clearly likelier, and simulates no worse."""
    beating = [
        rival
        for near in rivals.values()
        for rival in near
        if rival.behind < -LIMITS.swap_nats and not rival.simulates_worse
    ]
    return min(beating, key=lambda rival: rival.behind).structure if beating else None


def simulates_worse(best: Structure, trial: Structure, other: Effect) -> bool:
    """Whether free runs speak against `trial`, which has `other`.

    A new start does not know where a second body is. An effect with states of its own may therefore simulate
    worse, if fitted and check readings speak for it.
    """
    weight = weigh(trial, best)
    sure = bool(other.states) and weight.total < -LIMITS.sure_nats and weight.check_gain < 0.0
    return free_run_ratio(best, trial) >= (LIMITS.sure_rival_ratio if sure else LIMITS.rival_ratio)


def share_of_belief(behind: float, others: list[float]) -> float:
    """The share of belief for a structure `behind` the best by these nats; `others` lie behind it by theirs."""
    nearest = min(behind, *others, behind)
    return math.exp(nearest - behind) / sum(math.exp(nearest - other) for other in [behind, *others])
