"""In which regimes a model is wrong: the cells of speed and volts that methods point at, beside the true ones."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.blind.peers.answers import PEERS, folders_of_peers
from nxt_twin.blind.peers.recipes import cells_of
from nxt_twin.blind.peers.regression import EXPRESSED, Regression, regression_of
from nxt_twin.blind.spread import NameAndFailure
from nxt_twin.blind.verdict import read_sealed
from nxt_twin.blind.whole import write_whole
from nxt_twin.recording.case import read_case

OURS: Final = "nxt-twin"
TRUTH: Final = "truth"
_WRONG_SHARE: Final = 0.5

ChosenCells = Mapping[str, Collection[int]]
"""The cells that each method points at, by its name, and the true ones."""


def localise_all(
    folders: Sequence[Path], answers: Path, out: Path, named: Mapping[str, Path]
) -> list[ChosenCells]:
    """The cells that each method points at, of each case of which a regression tells the truth.

    `out` holds the other methods' answers; `named` the folder of each further method's.
    """
    kept = out / "localised"
    for folder in folders:
        localise_one(folder, answers / f"{folder.name}.json", {**named, **folders_of_peers(out)}, kept)
    return [json.loads(file.read_text(encoding="utf-8")) for file in sorted(kept.glob("*.json"))]


def localise_one(
    folder: Path, answer_file: Path, answers_of: Mapping[str, Path], out: Path
) -> NameAndFailure:
    """Write the cells that each method points at in one case to `out`; nothing where no regression tells the truth.

    `answers_of` names the folder of each method's answers.
    """
    target = out / f"{folder.name}.json"
    hidden = [str(effect["id"]) for effect in read_sealed(answer_file, folder)["effects"]]
    if target.exists() or not hidden or not set(hidden) <= set(EXPRESSED):
        return folder.name, ""
    regression = regression_of(read_case(folder))
    cells = {TRUTH: cells_of_names(regression, hidden)}
    pointing = {peer.name: peer.points for peer in PEERS if peer.points}
    for method, answers in answers_of.items():
        file = answers / f"{folder.name}.json"
        if method in pointing:
            cells[method] = pointing[method](regression)
        elif file.exists():
            effects = json.loads(file.read_text(encoding="utf-8"))["effects"]
            cells[method] = cells_of_names(regression, [str(effect["id"]) for effect in effects])
    write_whole(target, json.dumps({method: sorted(own) for method, own in cells.items()}))
    return folder.name, ""


def cells_of_names(case: Regression, names: Collection[str]) -> frozenset[int]:
    """Cells in which the terms of the named effects push at least half as hard as over all rows, in mean squares.

    The terms are fitted beside the plain model, each effect in the variant that fits best. An effect that a
    regression cannot express is in no cell.
    """
    target = case.without_base(case.acceleration)
    columns = [case.without_base(found) for name in names if (found := _best_variant(case, name)) is not None]
    if not columns:
        return frozenset()
    every = np.column_stack(columns)
    weights, *_ = np.linalg.lstsq(every, target, rcond=None)
    pushed = (every @ weights) ** 2
    cell = cells_of(case)
    wrong = [one for one in np.unique(cell) if pushed[cell == one].mean() >= _WRONG_SHARE * pushed.mean()]
    return frozenset(int(one) for one in wrong)


def f1(pairs: Iterable[tuple[Collection[int], Collection[int]]]) -> tuple[float, int] | None:
    """F1 of cells over all cases together, and how many cases; each pair holds the true cells and those given."""
    held = [(set(true), set(given)) for true, given in pairs]
    both = sum(len(true & given) for true, given in held)
    either = sum(len(true) + len(given) for true, given in held)
    return (2.0 * both / either, len(held)) if either else None


def _best_variant(case: Regression, name: str) -> FloatArray | None:
    target = case.without_base(case.acceleration)
    variants = [columns for (effect, _), columns in case.candidates.items() if effect == name]

    def left(columns: FloatArray) -> float:
        own = case.without_base(columns)
        weights, *_ = np.linalg.lstsq(own, target, rcond=None)
        return float(np.sum((target - own @ weights) ** 2))

    return min(variants, key=left) if variants else None
