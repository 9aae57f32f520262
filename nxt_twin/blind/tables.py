"""All tables of the proof, as text and as JSON values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from statistics import mean
from typing import Any

from nxt_twin.blind.absurd import absurd_rows
from nxt_twin.blind.by_family import EVERY, TableRow, family_rows, left_out_rows
from nxt_twin.blind.limits_in_turn import limits_in_turn_rows
from nxt_twin.blind.peers.localised import OURS
from nxt_twin.blind.peers.rows import peer_rows
from nxt_twin.blind.proof import FinishedCase, Proof
from nxt_twin.blind.told import (
    calibration_rows,
    confusion_rows,
    deletion_rows,
    floor_rows,
    reliability_rows,
    unknown_rows,
)


def tables_of(proof: Proof) -> dict[str, list[TableRow]]:
    """Each table by its title, of the cases that are finished."""
    cases, finished = proof.judged(), proof.finished()
    return {
        "families": family_rows(cases),
        "confusions of detectable single effects": confusion_rows(cases),
        "physics of nobody's library": unknown_rows(cases),
        "left out in turn": left_out_rows(cases),
        "the verdict's limits, left out in turn": limits_in_turn_rows(proof.recorded()),
        "reliability": reliability_rows(cases),
        "calibration, left out in turn": calibration_rows(cases),
        "taken out of the library": deletion_rows(proof.deletions()),
        "what no answer may say": absurd_rows(proof.answers()),
        "floor over the true structure's error": floor_rows(cases),
        "other methods": peer_rows({OURS: cases, **proof.peers()}, proof.cells()),
        "processor time": time_rows(finished),
        "no answer": [("case", "why"), *((_name(one), why) for one in finished for why in one.failed)],
    }


def proof_status(proof: Proof) -> str:
    """How far the range is, how much is left, and which engine answered, in one line each."""
    finished = proof.finished()
    engines = Counter(one.engine for one in finished)
    lines = [f"{proof.chosen.name}: {len(finished)} of {len(proof.cases)} cases are finished"]
    left = len(proof.cases) - len(finished)
    if left and finished:
        each_s = mean(sum(one.seconds.values()) for one in finished)
        lines.append(
            f"{left} cases are left: {left * each_s / 60.0:.0f} min of processor time at {each_s:.1f} s a case"
        )
    lines += [f"engine {name}: {count} cases" for name, count in engines.most_common()]
    if len(engines) > 1:
        lines.append("several engines answered: a new folder is needed for one engine's figures")
    return "\n".join(lines)


def time_rows(finished: Sequence[FinishedCase]) -> list[TableRow]:
    """Processor time of each step, by family: the mean over the cases that took it, s."""
    steps = list(dict.fromkeys(step for one in finished for step in one.seconds))
    rows: list[TableRow] = [("family", "cases", *(f"{step}, s" for step in steps), "together, s a case")]
    for family in (*sorted({one.case.order.family for one in finished}), EVERY):
        own = [one.seconds for one in finished if family in (one.case.order.family, EVERY)]
        means = [[seconds[step] for seconds in own if step in seconds] for step in steps]
        cells = [f"{mean(each):.1f}" if each else "-" for each in means]
        total = sum(map(sum, means)) / max(len(own), 1)
        rows.append((family, str(len(own)), *cells, f"{total:.1f}"))
    return rows


def as_text(rows: Sequence[TableRow]) -> str:
    """Rows in fixed-width columns."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = ("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in rows)
    return "\n".join(line.rstrip() for line in lines) + "\n"


def as_values(rows: Sequence[TableRow]) -> list[dict[str, Any]]:
    """Rows as JSON values."""
    return [dict(zip(rows[0], row, strict=True)) for row in rows[1:]]


def _name(one: FinishedCase) -> str:
    return f"{one.case.seed}/{one.case.order.plan.name}"
