"""Answers about concealed effects: confusions, unknown physics, probabilities, deletions, floors."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import mean, median, quantiles
from typing import Final, final

from nxt_twin.blind.aims import is_detectable
from nxt_twin.blind.by_family import EVERY, TableRow
from nxt_twin.blind.share import Share
from nxt_twin.blind.verdict import Judged
from nxt_twin.diagnose.telling.calibration import UNCONSIDERED

BINS: Final = (0.0, 0.5, 0.7, 0.8, 0.9, 0.91, 1.0)
FLOOR_BOUNDS: Final = (0.8, 1.25)
"""A floor is right within these multiples of the error of the true structure."""


def confusion_rows(cases: Sequence[Judged]) -> list[TableRow]:
    """Each hidden effect that is detectable alone: what became of it, and what was named in its place."""
    seen = [case for case in cases if case.kind == "single" and is_detectable(case)]
    rows: list[TableRow] = [
        ("hidden", "cases", "exact", "set holds", "adequate", "unexplained", "named otherwise")
    ]
    for effect in sorted({case.hidden[0] for case in seen}):
        own = [case for case in seen if case.hidden[0] == effect]
        rows.append(
            (
                effect,
                str(len(own)),
                str(sum(case.exact for case in own)),
                str(sum(case.holds for case in own)),
                str(sum(case.verdict == "adequate" for case in own)),
                str(sum(case.verdict == "unexplained" for case in own)),
                _names(case for case in own if case.verdict == "explained" and not case.exact),
            )
        )
    return rows


def unknown_rows(cases: Sequence[Judged]) -> list[TableRow]:
    """Each physics of nobody's library: how often it was refused, called nothing, and named as something else."""
    strange = [case for case in cases if case.kind == "unknown"]
    rows: list[TableRow] = [("hidden", "cases", "refused", "adequate", "misnamed", "named")]
    for effect in (*sorted({case.hidden[0] for case in strange}), EVERY):
        own = [case for case in strange if effect in (case.hidden[0], EVERY)]
        rows.append(
            (
                effect,
                str(len(own)),
                str(sum(case.exact for case in own)),
                str(sum(case.verdict == "adequate" for case in own)),
                str(sum(case.misnamed for case in own)),
                _names(case for case in own if case.misnamed) if effect != EVERY else "",
            )
        )
    return rows


def _names(cases: Iterable[Judged]) -> str:
    counts = Counter(" + ".join(case.named) for case in cases)
    return ", ".join(f"{names} {count}" for names, count in counts.most_common()) or "-"


def reliability_rows(cases: Sequence[Judged]) -> list[TableRow]:
    """Names by the probability given for them, beside how often they were hidden there."""
    told = [
        (probability, one in case.hidden)
        for case in cases
        if case.verdict == "explained"
        for one, probability in case.probability.items()
    ]
    rows: list[TableRow] = [("probability given", "names", "mean", "hit rate")]
    for low, high in pairwise(BINS):
        inside = [pair for pair in told if low <= pair[0] < high or (high == 1.0 and pair[0] == 1.0)]
        if inside:
            given, hits = mean(pair[0] for pair in inside), mean(float(pair[1]) for pair in inside)
            rows.append((f"{low:g} to {high:g}", str(len(inside)), f"{given:.2f}", f"{hits:.2f}"))
    return rows


def calibration_rows(cases: Sequence[Judged]) -> list[TableRow]:
    """Each family left out in turn: the chance of something else, learnt on the others, and what it gives here.

    A name's share of belief among what was weighed is multiplied by one less that chance.
    """
    rows: list[TableRow] = [
        (
            "left out",
            "names elsewhere",
            "chance of something else there",
            "names here",
            "mean told",
            "hit rate",
        )
    ]
    for family in sorted({case.family for case in cases}):
        others = _shares(case for case in cases if case.family != family)
        own = _shares(case for case in cases if case.family == family)
        if others and own:
            chance = chance_of_something_else(others)
            told = (1.0 - chance) * mean(share for share, _ in own)
            hits = str(Share(sum(hit for _, hit in own), len(own)))
            rows.append((family, str(len(others)), f"{chance:.3f}", str(len(own)), f"{told:.2f}", hits))
    return rows


def chance_of_something_else(shares: Sequence[tuple[float, bool]]) -> float:
    """How much more often names are wrong than their shares of belief tell, by Laplace's rule."""
    wrong = sum(share - float(hit) for share, hit in shares)
    return max(0.0, (wrong + 1.0) / (len(shares) + 2.0))


def _shares(cases: Iterable[Judged]) -> list[tuple[float, bool]]:
    """Each name's share of belief among what was weighed, and whether the named effect is hidden there."""
    return [
        (min(1.0, probability / (1.0 - UNCONSIDERED)), one in case.hidden)
        for case in cases
        if case.verdict == "explained"
        for one, probability in case.probability.items()
    ]


@final
@dataclass(frozen=True)
class Deleted:
    """A case whose effect was taken out of the library: the verdict, and the effects that it named."""

    verdict: str
    named: tuple[str, ...]


def deletion_rows(cases: Mapping[str, Sequence[Deleted]]) -> list[TableRow]:
    """Cases whose effect was taken out of the library: by effect, what became of them."""
    rows: list[TableRow] = [
        ("taken out", "cases", "unexplained", "another name", "adequate", "named in its place")
    ]
    for effect, each in [
        *sorted(cases.items()),
        (EVERY, [one for every in cases.values() for one in every]),
    ]:
        verdicts = ("unexplained", "explained", "adequate")
        counts = [sum(one.verdict == verdict for one in each) for verdict in verdicts]
        others = Counter(" + ".join(one.named) for one in each if one.verdict == "explained")
        told = ", ".join(f"{names} {count}" for names, count in others.most_common())
        rows.append((effect, str(len(each)), *map(str, counts), told if effect != EVERY else ""))
    return rows


def floor_rows(cases: Sequence[Judged]) -> list[TableRow]:
    """The floor over the error of the true structure re-fitted, by family and horizon.

    A floor rests on the model that was found. So the share of right floors also stands there for cases whose effects
    were all found, and no other.
    """
    low, high = FLOOR_BOUNDS
    within = f"within {low:g} to {high:g}"
    rows: list[TableRow] = [
        (
            "family",
            "windows",
            "cases",
            "10 %",
            "median",
            "90 %",
            within,
            "where named exactly",
            "is the error reached",
        )
    ]
    for family in (*sorted({case.family for case in cases}), EVERY):
        own = [case for case in cases if family in (case.family, EVERY)]
        for seconds in sorted({seconds for case in own for seconds in case.floors}):
            known = {id(case): ratio for case in own if (ratio := _floor_ratio(case, seconds)) is not None}
            if not known:
                continue
            ratios = list(known.values())
            right = [
                known[id(case)] for case in own if id(case) in known and set(case.named) == set(case.hidden)
            ]
            met = mean(
                float(case.floors[seconds] >= case.reached.get(seconds, math.inf))
                for case in own
                if id(case) in known
            )
            tenths = quantiles(ratios, n=10, method="inclusive") if len(ratios) > 1 else 9 * ratios
            figures = [f"{value:.2f}" for value in (tenths[0], median(ratios), tenths[8])]
            length = "whole" if math.isinf(seconds) else f"{seconds:g} s"
            shares = (f"{_within(ratios):.2f}", f"{_within(right):.2f} of {len(right)}" if right else "-")
            rows.append((family, length, str(len(ratios)), *figures, *shares, f"{met:.2f}"))
    return rows


def _within(ratios: Sequence[float]) -> float:
    """The share of floors that are right."""
    low, high = FLOOR_BOUNDS
    return mean(float(low <= ratio <= high) for ratio in ratios)


def _floor_ratio(case: Judged, seconds: float) -> float | None:
    """None where the library does not hold what is hidden, or the true structure reaches nothing finite.

    The true structure's error is that of the best fit of it that is known: one from the truth, or the diagnosis's own
    where that found just what is hidden.
    """
    if case.kind == "unknown" or case.reach is None or seconds not in case.floors:
        return None
    reached = case.reach.horizons.get(seconds, 0.0)
    if set(case.named) == set(case.hidden):
        reached = min(reached, case.reached.get(seconds, math.inf))
    return case.floors[seconds] / reached if 0.0 < reached < math.inf else None
