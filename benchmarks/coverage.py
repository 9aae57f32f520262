"""How often the 95 % intervals of a diagnosis hold the truth, on concealed cases of the development seeds.

`python -m benchmarks coverage` takes a few cases; `python -m benchmarks.coverage 350 50` seeds 350 to 399, and with a
further number as many effects in turn of each seed. Every case is made by the blind benchmark's own simulator. Only
cases in which exactly what is there was named are counted: the parameters of a wrong effect have no truth to hold.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

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
_TURN = 7
_LINKS = ("usb", "bluetooth")
_MOTOR = "motor"


@final
@dataclass(frozen=True)
class Held:
    """One interval beside its truth.

    Attributes:
        owner: the effect's id, or `motor`.
        name: the parameter's.
        main: whether it is an effect's main one.
        inside: whether the interval holds the truth.
        width: of the interval, relative to the truth.
    """

    owner: str
    name: str
    main: bool
    inside: bool
    width: float


def report(first: int = FIRST_SEED, count: int = _CASES, rounds: int = 1) -> list[str]:
    """Lines for main parameters, for all, for each effect and each parameter: how many hold, and how wide they are."""
    held: list[Held] = []
    named_exactly = 0
    for turn in range(rounds):
        for seed in range(first, first + count):
            diagnosis, answer = _diagnosed(seed, turn)
            if {effect.id for effect in diagnosis.effects} == {effect["id"] for effect in answer["effects"]}:
                named_exactly += 1
                held += _held(diagnosis, answer)
    cases = f"seeds {first} to {first + count - 1}, {rounds} x {count} cases of 3 x 15 s"
    owners = sorted({one.owner for one in held})
    names = sorted({(one.owner, one.name) for one in held})
    return [
        f"{cases}: {named_exactly} named exactly; 95 % intervals of these that hold the truth:",
        _line("main parameters", [one for one in held if one.main]),
        _line("all parameters", held),
        *(_line(owner, [one for one in held if one.owner == owner]) for owner in owners),
        *(
            _line(f"{own}.{name}", [h for h in held if (h.owner, h.name) == (own, name)])
            for own, name in names
        ),
    ]


def _line(words: str, held: Sequence[Held]) -> str:
    if not held:
        return f"{words}: none"
    width = float(np.median([one.width for one in held]))
    return f"{words}: {Share(sum(one.inside for one in held), len(held))}, median width {100.0 * width:.2g} %"


def _diagnosed(seed: int, turn: int) -> tuple[Diagnosis, Mapping[str, Any]]:
    rng = np.random.default_rng(seed)
    known = sorted(set(KNOWN_EFFECTS) & set(library()))
    place = seed - FIRST_SEED
    clean = turn == 0 and place % _CLEAN_EVERY == _CLEAN_EVERY - 1
    effects = () if clean else (known[(5 * place + _TURN * turn) % len(known)],)
    size = None if clean else SIZES[int(rng.integers(len(SIZES)))]
    made = make_case(seed, effects=effects, size=size, link=_LINKS[place % 2], duration_s=15.0)  # type: ignore[arg-type]
    listed = made.content["recordings"]
    fitted = tuple(r for r in made.recordings if r.name in listed)
    held_out = tuple(r for r in made.recordings if r.name not in listed)
    case = Case(made.name, Path(), made.content["plant"], fitted, held_out, "a")
    return diagnose(case).diagnosis, made.answer


def _held(diagnosis: Diagnosis, answer: Mapping[str, Any]) -> list[Held]:
    """Every parameter that has an interval and a truth."""
    found = []
    for name, moved in diagnosis.refit.items():
        if moved.interval_95 is not None and name in answer["base"] and name not in _untold(answer):
            found.append(_one(_MOTOR, name, moved.interval_95, answer["base"][name], main=False))
    hidden = {effect["id"]: effect for effect in answer["effects"]}
    for effect in diagnosis.effects:
        truth = hidden[effect.id]
        for name, estimate in effect.params.items():
            if name in truth["params"] and estimate.interval_95 is not None:
                true = truth["params"][name]
                found.append(_one(effect.id, name, estimate.interval_95, true, main=name == truth["main"]))
    return found


def _one(owner: str, name: str, interval: tuple[float, float], truth: float, *, main: bool) -> Held:
    low, high = interval
    if name == "phase_deg":  # known but for whole turns
        middle = 0.5 * (low + high)
        truth = middle + math.remainder(truth - middle, 360.0)
    return Held(owner, name, main, low <= truth <= high, (high - low) / max(abs(truth), 1e-12))


def _untold(answer: Mapping[str, Any]) -> set[str]:
    """Names of the motor's own parameters of which the answer does not hold the truth."""
    ids = {effect["id"] for effect in answer["effects"]}
    own = {name for effect in answer["effects"] for name in effect["params"]}
    return own | {"inertia_kg_m2"} if "gravity_load" in ids else own  # the arm's own inertia comes on top


if __name__ == "__main__":
    print(*report(*map(int, sys.argv[1:])), sep="\n")
