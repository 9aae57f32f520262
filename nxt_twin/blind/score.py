"""The benchmark's table: how often diagnoses are right, per effect, size and detectability."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any, Final, final

from nxt_twin.blind.aims import Aim, aims_of, is_detectable
from nxt_twin.blind.aims import as_text as aims_as_text
from nxt_twin.blind.location import Location, location
from nxt_twin.blind.reached import Reach, reached
from nxt_twin.blind.share import Share
from nxt_twin.blind.verdict import (
    NOTHING_GIVEN,
    Judged,
    judge,
    parse_diagnosis,
    read_sealed,
)
from nxt_twin.errors import CaseError

RMS_BINS_DEG: Final = (0.0, 1.0, 3.0, 10.0, 30.0, 100.0, math.inf)


@final
@dataclass(frozen=True)
class ScoreRow:
    """One line of the table: a group of cases and what became of them.

    Attributes:
        group: what the cases have in common.
        exact: cases with the right verdict and exactly the right names (an unknown effect: refused).
        holds: cases in which all that was hidden is named or listed as confusable.
        missed: cases called adequate.
        misnamed: cases explained by something that is not there.
        set_size: mean number of effects named or listed as confusable, where any is.
        parameter_error: median relative error of main parameters, as printed; None without any.
        parameter_error_own: the same relative to the motor's own inertia or resistance.
        fit_ratio: median of improved error over noise floor on held-out data; None without any.
    """

    group: str
    exact: Share
    holds: Share
    missed: Share
    misnamed: Share
    set_size: float | None
    parameter_error: float | None
    parameter_error_own: float | None
    fit_ratio: float | None


@final
@dataclass(frozen=True)
class ScoreTable:
    """All rows, and the cases behind them."""

    rows: tuple[ScoreRow, ...]
    cases: tuple[Judged, ...]

    def row(self, group: str) -> ScoreRow:
        """The line of one group."""
        return next(row for row in self.rows if row.group == group)

    def as_dict(self) -> dict[str, Any]:
        """The table as JSON values."""
        return {
            "schema": "nxt-twin/score/1",
            "rows": [_row_dict(row) for row in self.rows],
            "where": self.where.as_dict(),
            "aims": [{**vars(aim), "met": aim.met} for aim in self.aims],
            "cases": [_case_dict(case) for case in self.cases],
        }

    @property
    def aims(self) -> list[Aim]:
        """The aims, beside the figures reached."""
        return aims_of(self.cases)

    @property
    def where(self) -> Location:
        """How often the equation and the onset are right."""
        return location(self.cases)

    def as_text(self) -> str:
        """The table for a terminal or a page, in fixed-width columns."""
        head = ("cases", "exact", "holds truth", "called adequate", "misnamed", "set", "error", "own", "fit")
        cells = [head, *(_row_cells(row) for row in self.rows)]
        widths = [max(len(line[column]) for line in cells) for column in range(len(head))]
        lines = (
            "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)) for line in cells
        )
        return (
            "\n".join(line.rstrip() for line in lines)
            + f"\n{_COLUMNS}\n\n"
            + self.where.as_text()
            + "\n"
            + aims_as_text(self.aims)
        )


_COLUMNS = """
exact            right verdict and exactly the right effects; of an unknown effect: the verdict unexplained
holds truth      every hidden effect is named, or listed as one that it could be confused with
called adequate  something was hidden and the verdict is adequate
misnamed         an effect is named that is not hidden
set              mean number of effects that are named or listed as confusable
error, own       median relative error of the main parameters: as printed; relative to the motor's inertia or resistance
fit              median error on held-out data, in multiples of the noise floor
Shares have their 95 % interval in brackets."""


def score(
    cases_dir: Path, answers_dir: Path, diagnoses_dir: Path, reached_dir: Path | None = None
) -> ScoreTable:
    """Judge every case that has an answer.

    Args:
        cases_dir: holds the case folders with their seals.
        answers_dir: holds one `<case>.json` a case.
        diagnoses_dir: holds one `<case>.json` (docs/formats.md#diagnosis-json); a missing one counts as no answer.
        reached_dir: holds one `<case>.json` for each case of which is known what the true structure reaches.

    Raises:
        CaseError: if there are no answers, one is not what was sealed, or a diagnosis is not one.
    """
    files = sorted(answers_dir.glob("*.json"))
    if not files:
        raise CaseError("holds no answers", where=str(answers_dir))
    return tabulate([judged_case(file, cases_dir, diagnoses_dir, reached_dir) for file in files])


def judged_case(answer_file: Path, cases_dir: Path, diagnoses_dir: Path, reached_dir: Path | None) -> Judged:
    """Judge one case by its sealed answer; a diagnosis that is not there counts as no answer.

    Raises:
        CaseError: if the answer is not what was sealed, or a diagnosis is not one.
    """
    answer = read_sealed(answer_file, cases_dir / answer_file.stem)
    reach = _reach(reached_dir / answer_file.name) if reached_dir else None
    diagnosis_file = diagnoses_dir / answer_file.name
    if not diagnosis_file.exists():
        return judge(answer, NOTHING_GIVEN, reach)
    try:
        diagnosis = json.loads(diagnosis_file.read_text(encoding="utf-8"))
    except ValueError as failure:
        raise CaseError(f"is no JSON: {failure}", where=str(diagnosis_file)) from None
    return judge(answer, parse_diagnosis(diagnosis, str(diagnosis_file)), reach)


def _reach(file: Path) -> Reach | None:
    """What is written there; None for a case whose effects the library does not hold."""
    held = json.loads(file.read_text(encoding="utf-8")) if file.exists() else None
    return reached(held) if held else None


def tabulate(cases: Sequence[Judged]) -> ScoreTable:
    """Count: by kind of case; for single effects by size, by detectability and by effect."""
    singles = [case for case in cases if case.kind == "single"]
    kinds = ("clean", "single", "pair", "triple", "unknown")
    groups: list[tuple[str, list[Judged]]] = [
        (kind, [case for case in cases if case.kind == kind]) for kind in kinds
    ]
    groups += [
        (f"single, {size}", [case for case in singles if case.sizes[0] == size])
        for size in ("small", "medium", "large")
    ]
    groups.append(("single, detectable", [case for case in singles if is_detectable(case)]))
    for low, high in pairwise(RMS_BINS_DEG):
        inside = [case for case in singles if low <= case.effect_rms_deg < high]
        groups.append((f"single, effect {low:g}–{high:g}°", inside))
    for effect in sorted({case.hidden[0] for case in singles}):
        groups.append((effect, [case for case in singles if case.hidden[0] == effect]))
    groups += _by_family(cases)
    return ScoreTable(tuple(_row(name, group) for name, group in groups if group), tuple(cases))


def _by_family(cases: Sequence[Judged]) -> list[tuple[str, list[Judged]]]:
    """Each kind of case of each family; nothing where there is one family only."""
    families = sorted({case.family for case in cases})
    if len(families) < 2:
        return []
    kinds = ("clean", "single", "pair", "triple", "unknown")
    groups = []
    for family in families:
        own = [case for case in cases if case.family == family]
        groups += [(f"{family}: {kind}", [case for case in own if case.kind == kind]) for kind in kinds]
        seen = [case for case in own if case.kind == "single" and is_detectable(case)]
        groups.append((f"{family}: single, detectable", seen))
    return groups


def _row(group: str, cases: Sequence[Judged]) -> ScoreRow:
    def share(holds: Callable[[Judged], bool]) -> Share:
        return Share(sum(holds(case) for case in cases), len(cases))

    return ScoreRow(
        group=group,
        exact=share(lambda case: case.exact),
        holds=share(lambda case: case.holds),
        missed=share(lambda case: case.verdict == "adequate"),
        misnamed=share(lambda case: case.misnamed),
        set_size=_mean(len(case.considered) for case in cases if case.considered),
        parameter_error=_median(error for case in cases for error in case.parameter_error.values()),
        parameter_error_own=_median(error for case in cases for error in case.parameter_error_own.values()),
        fit_ratio=_median(case.fit_ratio for case in cases if case.fit_ratio is not None),
    )


def _mean(values: Iterable[float]) -> float | None:
    held = list(values)
    return sum(held) / len(held) if held else None


def _median(values: Iterable[float]) -> float | None:
    held = list(values)
    return median(held) if held else None


def _row_dict(row: ScoreRow) -> dict[str, Any]:
    shares = {"exact": row.exact, "holds": row.holds, "called_adequate": row.missed, "misnamed": row.misnamed}
    return {
        "group": row.group,
        "cases": row.exact.of,
        **{
            name: {"count": share.count, "wilson_95": [round(bound, 4) for bound in share.interval]}
            for name, share in shares.items()
        },
        "mean_set_size": row.set_size,
        "median_parameter_error": row.parameter_error,
        "median_parameter_error_own": row.parameter_error_own,
        "median_fit_over_floor": row.fit_ratio,
    }


def _row_cells(row: ScoreRow) -> tuple[str, ...]:
    def number(value: float | None, form: str) -> str:
        return "" if value is None else format(value, form)

    return (
        row.group,
        str(row.exact),
        str(row.holds),
        str(row.missed),
        str(row.misnamed),
        number(row.set_size, ".1f"),
        number(row.parameter_error, ".0%"),
        number(row.parameter_error_own, ".0%"),
        number(row.fit_ratio, ".1f"),
    )


def _case_dict(case: Judged) -> dict[str, Any]:
    return {
        "case": case.name,
        "family": case.family,
        "kind": case.kind,
        "hidden": list(case.hidden),
        "sizes": list(case.sizes),
        "effect_rms_deg": case.effect_rms_deg,
        "verdict": case.verdict,
        "named": list(case.named),
        "considered": sorted(case.considered),
        "exact": case.exact,
        "holds": case.holds,
        "misnamed": case.misnamed,
        "parameter_error": dict(case.parameter_error),
        "parameter_error_own": dict(case.parameter_error_own),
        "covered": dict(case.covered),
        "fit_over_floor": case.fit_ratio,
        "equation": case.located.truth,
        "equation_named": case.located.named,
        "equation_unaided": case.located.unaided,
        "onset_error_s": case.located.onset_error_s,
        "reach": None if case.reach is None else case.reach.as_dict(),
    }
