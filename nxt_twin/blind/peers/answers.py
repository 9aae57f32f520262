"""What each method answers on a case, in the form that is scored; and what it can answer at all."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, final

from nxt_twin.blind.peers.process_noise import lacks_something
from nxt_twin.blind.peers.recipes import freed, lisdd, lisdd_cells, sindy
from nxt_twin.blind.peers.regression import EXPRESSED, Regression, regression_of
from nxt_twin.blind.spread import CaseTask, NameAndFailure, spread
from nxt_twin.blind.whole import write_whole
from nxt_twin.errors import NxtTwinError
from nxt_twin.fleet.workers.place import HERE, Place
from nxt_twin.recording.case import Case, read_case


@final
@dataclass(frozen=True)
class RivalMethod:
    """One method.

    Attributes:
        name: of the folder with its answers.
        words: its recipe, and what it can answer at all.
        answer: names what is missing in a case; None where it can only say that something is.
        names: whether it can name anything.
        points: the cells in which the method itself says that the model is wrong; None where it does not part them.
    """

    name: str
    words: str
    answer: Callable[[Case], tuple[str, ...] | None]
    names: bool = True
    points: Callable[[Regression], frozenset[int]] | None = None


def _naming(recipe: Callable[[Regression], tuple[str, ...]]) -> Callable[[Case], tuple[str, ...] | None]:
    return lambda case: recipe(regression_of(case))


_FORCES: Final = f"names {len(EXPRESSED)} effects; none of timing, encoder, second bodies, memory"
PEERS: Final[tuple[RivalMethod, ...]] = (
    RivalMethod("sindy", f"PySINDy on the discrepancy, threshold by held-out half seconds; {_FORCES}", _naming(sindy)),
    RivalMethod("lisdd", f"regimes, a sample-split F test, false discoveries controlled; {_FORCES}",
         _naming(lisdd), points=lisdd_cells),
    RivalMethod("freed", f"all terms freed at once, 95 % intervals; {_FORCES}; never unexplained", _naming(freed)),
    RivalMethod("ctsm", "likelihood ratio of process noise; names nothing, says that the torque balance is wrong",
         lambda case: None if lacks_something(case) else (), names=False),
)  # fmt: skip


def answer_all(folders: Sequence[Path], out: Path, place: Place = HERE) -> Iterator[NameAndFailure]:
    """Let each method answer each case into `out/METHOD/CASE.json`; yields names, and why one failed."""
    # Workers of a cluster have folders of their own to start from.
    tasks = [(folder.resolve(), out.resolve()) for folder in folders]
    yield from spread((CaseTask(task[0].name, answer_one, task) for task in tasks), place)


def answer_one(folder: Path, out: Path) -> NameAndFailure:
    """Let each method answer one case; those that have answered it are passed over."""
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
        write_whole(target, json.dumps(_diagnosis(named)))
    return folder.name, why


def _diagnosis(named: tuple[str, ...] | None) -> dict[str, Any]:
    """As much of a diagnosis as is scored."""
    verdict = "unexplained" if named is None else "explained" if named else "adequate"
    effects = [{"id": one, "params": {}, "confusable_with": [], "probability": 1.0} for one in named or ()]
    return {"verdict": verdict, "effects": effects, "refit": {}, "fit": {"improved": None, "floor": None}}


def folders_of_peers(out: Path) -> dict[str, Path]:
    """The folder of each method's answers, by its name; of those that name something."""
    return {peer.name: out / peer.name for peer in PEERS if peer.names}
