"""What is asked of a diagnosis on each family, and what becomes of a limit that is set on the other families."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from statistics import mean, quantiles
from typing import Any, Final, final

from nxt_twin.blind.aims import detectable
from nxt_twin.blind.verdict import Judged

LIMITS: Final = (0.0, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99)
BINS: Final = (0.0, 0.5, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0)
EVERY: Final = "all"


@final
@dataclass(frozen=True)
class AimRow:
    """One aim: its words, how it is measured, its bound, whether more is better."""

    words: str
    measure: Callable[[Sequence[Judged]], float | None]
    bound: float
    at_least: bool

    def cell(self, cases: Sequence[Judged]) -> str:
        """What was reached, marked where it falls short."""
        value = self.measure(cases)
        if value is None:
            return "-"
        short = value < self.bound if self.at_least else value > self.bound
        return f"{value:.2f}{' !' if short else ''}"


def _share(
    of: Callable[[Judged], bool], holds: Callable[[Judged], bool]
) -> Callable[[Sequence[Judged]], float | None]:
    def measured(cases: Sequence[Judged]) -> float | None:
        held = [float(holds(case)) for case in cases if of(case)]
        return mean(held) if held else None

    return measured


def _kind(name: str) -> Callable[[Judged], bool]:
    return lambda case: case.kind == name


def _seen(case: Judged) -> bool:
    return case.kind == "single" and detectable(case)


def _ratios(cases: Sequence[Judged]) -> list[float]:
    """Error over that of the true structure re-fitted, on what nobody fitted."""
    return [
        case.improved / case.reach.held_out_rmse
        for case in cases
        if case.reach is not None and case.improved is not None and case.reach.held_out_rmse > 0.0
    ]


def _quantile(tenths: int) -> Callable[[Sequence[Judged]], float | None]:
    def measured(cases: Sequence[Judged]) -> float | None:
        ratios = _ratios(cases)
        return quantiles(ratios, n=10, method="inclusive")[tenths - 1] if len(ratios) > 1 else None

    return measured


ASKED: Final = (
    AimRow("exact", _share(_seen, lambda case: case.exact), 0.85, at_least=True),
    AimRow("holds", _share(_seen, lambda case: case.holds), 0.97, at_least=True),
    AimRow("clean wrong", _share(_kind("clean"), lambda case: not case.exact), 0.02, at_least=False),
    AimRow("pairs", _share(_kind("pair"), lambda case: case.exact), 0.65, at_least=True),
    AimRow("triples", _share(_kind("triple"), lambda case: case.exact), 0.0, at_least=True),
    AimRow("refused", _share(_kind("unknown"), lambda case: case.exact), 0.0, at_least=True),
    AimRow("misnamed", _share(_kind("unknown"), lambda case: case.misnamed), 0.10, at_least=False),
    AimRow("error ratio", _quantile(5), 1.1, at_least=False),
    AimRow("90 %", _quantile(9), 2.0, at_least=False),
)
"""`exact` and `holds` are of detectable single effects; ratios are of the error over that of the true structure."""


def family_rows(cases: Sequence[Judged]) -> list[tuple[str, ...]]:
    """Each family, and all together: how many cases, and each aim; what falls short is marked."""
    names = [*sorted({case.family for case in cases}), EVERY]
    rows = []
    for name in names:
        own = [case for case in cases if name in (case.family, EVERY)]
        rows.append((name, str(len(own)), *(asked.cell(own) for asked in ASKED)))
    aims = tuple(f"{'≥' if asked.at_least else '≤'} {asked.bound:g}" for asked in ASKED)
    return [("family", "cases", *(asked.words for asked in ASKED)), *rows, ("aim", "", *aims)]


def left_out_rows(cases: Sequence[Judged]) -> list[tuple[str, ...]]:
    """Each family left out in turn: the least probability of a name, set on the others, and what it gives on it.

    A name less probable than the limit is not given: the case comes back unexplained.
    """
    rows: list[tuple[str, ...]] = [("left out", "limit", *(asked.words for asked in ASKED))]
    for name in sorted({case.family for case in cases}):
        others = [case for case in cases if case.family != name]
        own = [case for case in cases if case.family == name]
        if others and own:
            limit = best_limit(others)
            held = [withheld(case, limit) for case in own]
            rows.append((name, f"{limit:g}", *(asked.cell(held) for asked in ASKED)))
    return rows


def best_limit(cases: Sequence[Judged]) -> float:
    """The limit with the highest mean of shares over the kinds of cases; of equal ones the least."""

    def worth(limit: float) -> float:
        held = [withheld(case, limit) for case in cases]
        shares = [asked.measure(held) for asked in ASKED if asked.words in ("exact", "pairs", "refused")]
        return (
            mean(share for share in shares if share is not None)
            if any(s is not None for s in shares)
            else 0.0
        )

    return max(LIMITS, key=lambda limit: (worth(limit), -limit))


def withheld(case: Judged, limit: float) -> Judged:
    """The case as it would be judged were names below a probability not given."""
    if case.verdict != "explained" or min(case.probability.values(), default=1.0) >= limit:
        return case
    return replace(case, verdict="unexplained", exact=case.kind == "unknown", misnamed=False)


def reliability_rows(cases: Sequence[Judged]) -> list[tuple[str, ...]]:
    """Names by the probability given for them, beside how often they were hidden there."""
    told = [
        (probability, one in case.hidden)
        for case in cases
        if case.verdict == "explained"
        for one, probability in case.probability.items()
    ]
    rows: list[tuple[str, ...]] = [("probability given", "names", "mean", "hit rate")]
    for low, high in pairwise(BINS):
        inside = [pair for pair in told if low <= pair[0] < high or (high == 1.0 and pair[0] == 1.0)]
        if inside:
            given, hits = mean(pair[0] for pair in inside), mean(float(pair[1]) for pair in inside)
            rows.append((f"{low:g} to {high:g}", str(len(inside)), f"{given:.2f}", f"{hits:.2f}"))
    return rows


def deletion_rows(verdicts: Mapping[str, Sequence[str]]) -> list[tuple[str, ...]]:
    """Cases whose effect was taken out of the library: by effect, what became of them."""
    rows: list[tuple[str, ...]] = [("taken out", "cases", "unexplained", "another name", "adequate")]
    for effect, each in [
        *sorted(verdicts.items()),
        (EVERY, [one for every in verdicts.values() for one in every]),
    ]:
        counts = [sum(one == verdict for one in each) for verdict in ("unexplained", "explained", "adequate")]
        rows.append((effect, str(len(each)), *map(str, counts)))
    return rows


def as_text(rows: Sequence[tuple[str, ...]]) -> str:
    """Rows in fixed-width columns."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = ("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in rows)
    return "\n".join(line.rstrip() for line in lines) + "\n"


def as_values(rows: Sequence[tuple[str, ...]]) -> list[dict[str, Any]]:
    """Rows as JSON values."""
    return [dict(zip(rows[0], row, strict=True)) for row in rows[1:]]
