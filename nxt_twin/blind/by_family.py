"""Aims for a diagnosis on each family, and the result there of a limit that was set on the other families."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from statistics import mean, quantiles
from typing import Final, final

from nxt_twin.blind.aims import is_detectable, shows_each
from nxt_twin.blind.verdict import Judged

LIMITS: Final = (0.0, 0.5, 0.6, 0.7, 0.8, 0.9, 0.91)
EVERY: Final = "all"

TableRow = tuple[str, ...]
Measured = tuple[float, int]
"""A figure, and how many cases it rests on."""


@final
@dataclass(frozen=True)
class AimRow:
    """One aim: its words, how it is measured (None without any case), its bound, whether more is better."""

    words: str
    measure: Callable[[Sequence[Judged]], Measured | None]
    bound: float
    at_least: bool

    def cell(self, cases: Sequence[Judged]) -> str:
        """The figure reached and its number of cases, marked where it misses its aim."""
        found = self.measure(cases)
        if found is None:
            return "-"
        value, of = found
        short = value < self.bound if self.at_least else value > self.bound
        return f"{value:.2f} of {of}{' !' if short else ''}"

    @property
    def aim(self) -> str:
        """The bound in words; a share that has no aim says so."""
        if self.at_least and self.bound == 0.0:
            return "told"
        return f"{'≥' if self.at_least else '≤'} {self.bound:g}"


def _mean(
    of: Callable[[Judged], bool], value: Callable[[Judged], float]
) -> Callable[[Sequence[Judged]], Measured | None]:
    def measured(cases: Sequence[Judged]) -> Measured | None:
        held = [float(value(case)) for case in cases if of(case)]
        return (mean(held), len(held)) if held else None

    return measured


def _kind(name: str) -> Callable[[Judged], bool]:
    return lambda case: case.kind == name


def _seen(case: Judged) -> bool:
    return case.kind == "single" and is_detectable(case)


def _shown_pair(case: Judged) -> bool:
    return case.kind == "pair" and shows_each(case)


def _ratios(cases: Sequence[Judged]) -> list[float]:
    """Error over that of the true structure re-fitted, on what nobody fitted."""
    return [
        case.improved / case.reach.held_out_rmse
        for case in cases
        if case.reach is not None and case.improved is not None and case.reach.held_out_rmse > 0.0
    ]


def _quantile(tenths: int) -> Callable[[Sequence[Judged]], Measured | None]:
    def measured(cases: Sequence[Judged]) -> Measured | None:
        ratios = _ratios(cases)
        if len(ratios) < 2:
            return None
        return quantiles(ratios, n=10, method="inclusive")[tenths - 1], len(ratios)

    return measured


_EXACT: Final = AimRow(
    "single, detectable: exact", _mean(_seen, lambda case: case.exact), 0.85, at_least=True
)
_PAIRS: Final = AimRow("pairs: exact", _mean(_kind("pair"), lambda case: case.exact), 0.65, at_least=True)
_REFUSED: Final = AimRow(
    "unknown: refused", _mean(_kind("unknown"), lambda case: case.exact), 0.0, at_least=True
)
ASKED: Final = (
    _EXACT,
    AimRow("single, detectable: set holds the truth", _mean(_seen, lambda c: c.holds), 0.97, at_least=True),
    AimRow("single, detectable: size of the set", _mean(_seen, lambda c: len(c.considered)), 2.0, at_least=False),
    AimRow("clean: called wrong", _mean(_kind("clean"), lambda case: not case.exact), 0.02, at_least=False),
    _PAIRS,
    AimRow("pairs that show both: exact", _mean(_shown_pair, lambda case: case.exact), 0.0, at_least=True),
    AimRow("triples: exact", _mean(_kind("triple"), lambda case: case.exact), 0.0, at_least=True),
    _REFUSED,
    AimRow("unknown: misnamed", _mean(_kind("unknown"), lambda case: case.misnamed), 0.10, at_least=False),
    AimRow("error over the true structure's: median", _quantile(5), 1.1, at_least=False),
    AimRow("error over the true structure's: 90 %", _quantile(9), 2.0, at_least=False),
)  # fmt: skip
"""Ratios are of the error on what no fit saw over that of the true structure re-fitted."""


def family_rows(cases: Sequence[Judged]) -> list[TableRow]:
    """Each aim, for each family and all together; what falls short is marked."""
    names = [*sorted({case.family for case in cases}), EVERY]
    own = {name: [case for case in cases if name in (case.family, EVERY)] for name in names}
    rows = [(asked.words, *(asked.cell(own[name]) for name in names), asked.aim) for asked in ASKED]
    return [("", *names, "aim"), ("cases", *(str(len(own[name])) for name in names), ""), *rows]


def left_out_rows(cases: Sequence[Judged]) -> list[TableRow]:
    """Each family left out in turn: the least probability of a name, set on the others, and what it gives on it.

    A name less probable than the limit is not given: the case comes back unexplained.
    """
    families = sorted({case.family for case in cases})
    held: dict[str, tuple[float, list[Judged]]] = {}
    for name in families:
        others = [case for case in cases if case.family != name]
        if others:
            limit = best_limit(others)
            held[name] = limit, [withheld(case, limit) for case in cases if case.family == name]
    rows = [(asked.words, *(asked.cell(own) for _, own in held.values()), asked.aim) for asked in ASKED]
    limits = [f"{limit:g}" for limit, _ in held.values()]
    return [("left out", *held, "aim"), ("least probability of a name", *limits, ""), *rows]


def best_limit(cases: Sequence[Judged]) -> float:
    """The limit with the highest mean of shares over the kinds of cases; of equal ones the least."""

    def worth(limit: float) -> float:
        held = [withheld(case, limit) for case in cases]
        found = [asked.measure(held) for asked in (_EXACT, _PAIRS, _REFUSED)]
        shares = [one[0] for one in found if one is not None]
        return mean(shares) if shares else 0.0

    return max(LIMITS, key=lambda limit: (worth(limit), -limit))


def withheld(case: Judged, limit: float) -> Judged:
    """The case as it would be judged were names below a probability not given."""
    if case.verdict != "explained" or min(case.probability.values(), default=1.0) >= limit:
        return case
    return replace(case, verdict="unexplained", exact=case.kind == "unknown", misnamed=False)
