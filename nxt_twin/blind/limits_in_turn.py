"""The verdict's limits, set anew on all families but one, and what they then give on that one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from statistics import mean
from typing import Final, final

from nxt_twin.blind.by_family import TableRow
from nxt_twin.blind.share import Share
from nxt_twin.blind.verdict import Judged, is_exact
from nxt_twin.diagnose.judging.verdict import LIMITS, Record, VerdictLimits, verdict_of

MOVED: Final = (0.5, 0.7, 1.4, 2.0)
MOST_MOVES: Final = 4


@final
@dataclass(frozen=True)
class Recorded:
    """A judged case, and the numbers on which its verdict rests."""

    case: Judged
    record: Record

    def exact(self, limits: VerdictLimits) -> bool:
        """Whether the verdict would be right with other limits; the names stay as they are."""
        return is_exact(self.case, verdict_of(self.record, limits))


def limits_in_turn_rows(cases: Sequence[Recorded]) -> list[TableRow]:
    """Each family left out: the limits that the others would move, and right answers here before and after."""
    rows: list[TableRow] = [("left out", "limits moved elsewhere", "right as they are", "right with those")]
    for family in sorted({one.case.family for one in cases}):
        own = [one for one in cases if one.case.family == family]
        others = [one for one in cases if one.case.family != family]
        if others:
            limits = best_limits(others)
            moved = [name for name in _NAMES if getattr(limits, name) != getattr(LIMITS, name)]
            words = ", ".join(f"{name} {getattr(limits, name):g}" for name in moved) or "none"
            rows.append((family, words, *(_right(own, each) for each in (LIMITS, limits))))
    return rows


def best_limits(cases: Sequence[Recorded]) -> VerdictLimits:
    """The engine's limits, moved one after the other as long as more answers are right, in the mean over kinds."""
    best = LIMITS
    for _ in range(MOST_MOVES):
        trial = max(_neighbours(best), key=lambda limits: worth(cases, limits))
        if worth(cases, trial) <= worth(cases, best):
            break
        best = trial
    return best


def worth(cases: Sequence[Recorded], limits: VerdictLimits) -> float:
    """The share of right answers, in the mean over the kinds of cases."""
    kinds = {one.case.kind for one in cases}
    return mean(mean(float(one.exact(limits)) for one in cases if one.case.kind == kind) for kind in kinds)


_NAMES: Final = tuple(field.name for field in fields(VerdictLimits) if field.type == "float")


def _neighbours(limits: VerdictLimits) -> Iterator[VerdictLimits]:
    for name in _NAMES:
        for times in MOVED:
            yield replace(limits, **{name: times * getattr(limits, name)})


def _right(cases: Sequence[Recorded], limits: VerdictLimits) -> str:
    return str(Share(sum(one.exact(limits) for one in cases), len(cases)))
