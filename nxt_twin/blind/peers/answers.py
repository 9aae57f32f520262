"""What each method answers on a case, in the form that is scored; and what it can answer at all."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, final

from nxt_twin.blind.peers.process_noise import lacks_something
from nxt_twin.blind.peers.recipes import freed, lisdd, sindy
from nxt_twin.blind.peers.regression import EXPRESSED, Regression, regression_of
from nxt_twin.blind.share import share_of
from nxt_twin.blind.verdict import Judged
from nxt_twin.errors import NxtTwinError
from nxt_twin.recording.case import Case, read_case


@final
@dataclass(frozen=True)
class RivalMethod:
    """One method.

    Attributes:
        name: of the folder with its answers.
        words: its recipe, and what it can answer at all.
        answer: names what is missing in a case; None where it can only say that something is.
    """

    name: str
    words: str
    answer: Callable[[Case], tuple[str, ...] | None]


def _naming(recipe: Callable[[Regression], tuple[str, ...]]) -> Callable[[Case], tuple[str, ...] | None]:
    return lambda case: recipe(regression_of(case))


_FORCES: Final = f"names {len(EXPRESSED)} effects; none of timing, encoder, second bodies, memory"
PEERS: Final[tuple[RivalMethod, ...]] = (
    RivalMethod("sindy", f"PySINDy on the discrepancy, threshold by held-out half seconds; {_FORCES}", _naming(sindy)),
    RivalMethod("lisdd", f"regimes, a sample-split F test, false discoveries controlled; {_FORCES}", _naming(lisdd)),
    RivalMethod("freed", f"all terms freed at once, 95 % intervals; {_FORCES}; never unexplained", _naming(freed)),
    RivalMethod("ctsm", "likelihood ratio of process noise; names nothing, says that the torque balance is wrong",
         lambda case: None if lacks_something(case) else ()),
)  # fmt: skip


def answer_all(folders: Sequence[Path], out: Path) -> Iterator[tuple[str, str]]:
    """Let each method answer each case into `out/METHOD/CASE.json`; yields names, and why one failed."""
    for peer in PEERS:
        (out / peer.name).mkdir(parents=True, exist_ok=True)
    for folder in folders:
        why = ""
        for peer in PEERS:
            target = out / peer.name / f"{folder.name}.json"
            if target.exists():
                continue
            try:
                named = peer.answer(read_case(folder))
            except NxtTwinError as error:
                why = str(error)
                continue
            target.write_text(json.dumps(_diagnosis(named)), encoding="utf-8")
        yield folder.name, why


def _diagnosis(named: tuple[str, ...] | None) -> dict[str, Any]:
    """As much of a diagnosis as is scored."""
    verdict = "unexplained" if named is None else "explained" if named else "adequate"
    effects = [{"id": one, "params": {}, "confusable_with": [], "probability": 1.0} for one in named or ()]
    return {"verdict": verdict, "effects": effects, "refit": {}, "fit": {"improved": None, "floor": None}}


def peer_rows(judged: Mapping[str, Sequence[Judged]]) -> list[tuple[str, ...]]:
    """Each method: single effects named exactly, those among what is named, clean called wrong, false names."""
    rows: list[tuple[str, ...]] = [
        (
            "method",
            "single: exact",
            "named among others",
            "clean: called wrong",
            "unknown: misnamed",
            "names not there",
        )
    ]
    for name, cases in judged.items():
        singles = [case for case in cases if case.kind == "single"]
        told = [one not in case.hidden for case in cases for one in case.named]
        rows.append(
            (
                name,
                str(share_of(case.exact for case in singles)),
                str(share_of(set(case.hidden) <= set(case.named) for case in singles)),
                str(share_of(not case.exact for case in cases if case.kind == "clean")),
                str(share_of(case.misnamed for case in cases if case.kind == "unknown")),
                str(share_of(told)),
            )
        )
    return rows
