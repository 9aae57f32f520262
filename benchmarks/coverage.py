"""How often the 95 % intervals of a diagnosis hold the truth, on concealed cases of the development seeds.

`python -m benchmarks coverage` takes a few cases; `python -m benchmarks.coverage 300 50` seeds 300 to 349.
Every case is made by the blind benchmark's own simulator. Only cases in which exactly what is there was named
are counted: the parameters of a wrong effect have no truth to hold.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from nxt_twin.blind.effects.concealed import SIZES
from nxt_twin.blind.effects.library import KNOWN_EFFECTS
from nxt_twin.blind.make import make_case
from nxt_twin.blind.score import Share
from nxt_twin.diagnose.diagnosis import Diagnosis
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.physics.library import library
from nxt_twin.recording.case import Case

FIRST_SEED = 300
_CASES = 8
_CLEAN_EVERY = 4
_LINKS = ("usb", "bluetooth")


def report(first: int = FIRST_SEED, count: int = _CASES) -> list[str]:
    """One line for each parameter and one for all: how many intervals hold the truth, and how wide they are."""
    held: dict[str, list[bool]] = {}
    widths: dict[str, list[float]] = {}
    named_exactly = 0
    for seed in range(first, first + count):
        diagnosis, answer = _diagnosed(seed)
        if {effect.id for effect in diagnosis.effects} != {effect["id"] for effect in answer["effects"]}:
            continue
        named_exactly += 1
        for name, (low, high), truth in _intervals(diagnosis, answer):
            held.setdefault(name, []).append(low <= truth <= high)
            widths.setdefault(name, []).append((high - low) / max(abs(truth), 1e-12))
    every = [inside for some in held.values() for inside in some]
    lines = [f"seeds {first} to {first + count - 1}: {named_exactly} of {count} named exactly, 3 x 15 s each"]
    lines.append(f"95 % intervals that hold the truth, all parameters: {Share(sum(every), len(every))}")
    lines += [
        f"{name}: {Share(sum(some), len(some))}, median width {100.0 * float(np.median(widths[name])):.2g} %"
        for name, some in sorted(held.items())
    ]
    return lines


def _diagnosed(seed: int) -> tuple[Diagnosis, Mapping[str, Any]]:
    rng = np.random.default_rng(seed)
    known = sorted(set(KNOWN_EFFECTS) & set(library()))
    place = seed - FIRST_SEED
    clean = place % _CLEAN_EVERY == _CLEAN_EVERY - 1
    effects = () if clean else (known[(5 * place) % len(known)],)
    size = None if clean else SIZES[int(rng.integers(len(SIZES)))]
    made = make_case(seed, effects=effects, size=size, link=_LINKS[place % 2], duration_s=15.0)  # type: ignore[arg-type]
    listed = made.content["recordings"]
    fitted = tuple(r for r in made.recordings if r.name in listed)
    held_out = tuple(r for r in made.recordings if r.name not in listed)
    case = Case(made.name, Path(), made.content["plant"], fitted, held_out, "a")
    return diagnose(case).diagnosis, made.answer


def _intervals(
    diagnosis: Diagnosis, answer: Mapping[str, Any]
) -> list[tuple[str, tuple[float, float], float]]:
    """Name, interval and truth of each parameter that has all three."""
    found = []
    for name, moved in diagnosis.refit.items():
        if moved.interval_95 is not None and name in answer["base"] and name not in _hidden(answer):
            found.append((name, moved.interval_95, float(answer["base"][name])))
    truths = {effect["id"]: effect["params"] for effect in answer["effects"]}
    for effect in diagnosis.effects:
        for name, estimate in effect.params.items():
            truth = truths[effect.id].get(name)
            if truth is not None and estimate.interval_95 is not None and math.isfinite(truth):
                found.append((f"{effect.id}.{name}", estimate.interval_95, float(truth)))
    return found


def _hidden(answer: Mapping[str, Any]) -> set[str]:
    return {name for effect in answer["effects"] for name in effect["params"]}


if __name__ == "__main__":
    print(*report(*map(int, sys.argv[1:])), sep="\n")
