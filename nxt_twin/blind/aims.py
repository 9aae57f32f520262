"""The benchmark's aims for a diagnosis engine, and whether a table meets them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import mean, median
from typing import Final, final

from nxt_twin.blind.verdict import CaseKind, Judged

DETECTABLE_NATS: Final = 10.0
"""A case counts as detectable where the true structure itself, fitted from its true sizes, beats the re-fitted
baseline by this number of nats on the readings that are fitted."""


@final
@dataclass(frozen=True)
class Aim:
    """One aim beside what was reached.

    Attributes:
        words: what is asked for.
        measured: None where no case tells.
        bound: the aim.
        at_least: whether more is better.
        cases: how many cases, or parameters, it rests on.
    """

    words: str
    measured: float | None
    bound: float
    at_least: bool
    cases: int

    @property
    def met(self) -> bool:
        """Whether it is reached."""
        if self.measured is None:
            return False
        return self.measured >= self.bound if self.at_least else self.measured <= self.bound


def is_detectable(case: Judged) -> bool:
    """Whether what is hidden could be seen at all."""
    return case.reach is not None and case.reach.gain_nats > DETECTABLE_NATS


def shows_each(case: Judged) -> bool:
    """Whether each of several hidden effects could be seen beside the others, as a single one beside nothing."""
    gains = {} if case.reach is None else case.reach.each_gain_nats
    return set(gains) == set(case.hidden) and all(gain > DETECTABLE_NATS for gain in gains.values())


def aims_of(cases: Sequence[Judged]) -> list[Aim]:
    """Every aim, measured on these cases."""
    singles = _of(cases, "single")
    seen = [case for case in singles if is_detectable(case)]
    clean, pairs, triples = (_of(cases, kind) for kind in ("clean", "pair", "triple"))
    unknown = _of(cases, "unknown")
    known = [*singles, *pairs, *triples]
    return [
        _share("single, detectable: exact name", seen, lambda case: case.exact, 0.88),
        _share("single, detectable: set holds the truth", seen, lambda case: case.holds, 0.96),
        _mean("single, detectable: mean size of the set", seen, lambda case: len(case.considered), 2.0),
        _share("clean: called wrong", clean, lambda case: not case.exact, 0.03, at_least=False),
        _share("pairs: exact", pairs, lambda case: case.exact, 0.65),
        _share("pairs that show both: exact", list(filter(shows_each, pairs)), lambda case: case.exact, 0.0),
        _share("triples: exact", triples, lambda case: case.exact, 0.0),
        _share("unknown: refused", unknown, lambda case: case.exact, 0.60),
        _share("unknown: confidently misnamed", unknown, lambda case: case.misnamed, 0.15, at_least=False),
        _median("free run over that of the true structure, median", known, _over_true, 1.15),
        _median("relative error of the main parameter, median", seen, _worst_error, 0.10),
        _cover(known, 0.90, at_least=True),
        _cover(known, 0.98, at_least=False),
    ]  # fmt: skip


def as_text(aims: Sequence[Aim]) -> str:
    """The aims as lines for a terminal."""
    lines = []
    for aim in aims:
        measured = "no case" if aim.measured is None else f"{aim.measured:.3g}"
        sign = "≥" if aim.at_least else "≤"
        said = "met" if aim.met else "MISSED" if aim.measured is not None else "-"
        lines.append(f"{aim.words:55} {measured:>8}  {sign} {aim.bound:<5g} {said:7} of {aim.cases}")
    return "\n".join(lines) + "\n"


def _of(cases: Sequence[Judged], kind: CaseKind) -> list[Judged]:
    return [case for case in cases if case.kind == kind]


def _share(
    words: str,
    cases: Sequence[Judged],
    holds: Callable[[Judged], bool],
    bound: float,
    *,
    at_least: bool = True,
) -> Aim:
    share = mean(float(holds(case)) for case in cases) if cases else None
    return Aim(words, share, bound, at_least, len(cases))


def _mean(words: str, cases: Sequence[Judged], value: Callable[[Judged], float], bound: float) -> Aim:
    held = [value(case) for case in cases]
    return Aim(words, mean(held) if held else None, bound, at_least=False, cases=len(held))


def _median(
    words: str, cases: Sequence[Judged], value: Callable[[Judged], float | None], bound: float
) -> Aim:
    held = [found for case in cases if (found := value(case)) is not None]
    return Aim(words, median(held) if held else None, bound, at_least=False, cases=len(held))


def _over_true(case: Judged) -> float | None:
    if case.reach is None or case.improved is None or not case.reach.held_out_rmse:
        return None
    return case.improved / case.reach.held_out_rmse


def _worst_error(case: Judged) -> float | None:
    return max(case.parameter_error.values(), default=None)


def _cover(cases: Sequence[Judged], bound: float, *, at_least: bool) -> Aim:
    """Over the main parameters of all that was named, where exactly what was hidden was named."""
    held = [inside for case in cases if case.exact for inside in case.covered.values()]
    words = f"main parameter within its 95 % interval, at {'least' if at_least else 'most'}"
    return Aim(words, mean(map(float, held)) if held else None, bound, at_least, len(held))
