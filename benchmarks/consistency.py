"""Whether what is fitted also simulates: errors in windows of 2 s and over whole runs of what no fit saw.

`python -m benchmarks.consistency 21 8` takes seeds 21 to 28: a motor with play and one with a shaft that twists, each.
It prints the error of the re-fitted baseline over that of a plain fit of windows by scipy. Beside it stands the error
of the true structure, fitted from the true parameters, over that of the true parameters themselves.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import final

import numpy as np

from benchmarks.plain_windows import WINDOW_S, fitted_on_windows
from nxt_twin.blind.case import ConcealedCase
from nxt_twin.blind.make import make_case
from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting.everything import fit_everything
from nxt_twin.diagnose.fitting.fitter import Fitter
from nxt_twin.diagnose.fitting.noise import first_guess
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.judging.horizons import Errors, errors_of
from nxt_twin.diagnose.search.searched import best_baseline, settled_baseline
from nxt_twin.diagnose.search.settling import settled
from nxt_twin.physics.plant import Plant, plant_from_config
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.case import Case

EFFECTS = ("backlash", "shaft_compliance")
FIRST_SEED, SEEDS = 21, 8
MOST_OVER_THE_PLAIN_FIT = 1.1
MOST_OVER_THE_TRUTH = 1.2
_DURATION_S = 12.0


@final
@dataclass(frozen=True)
class Consistency:
    """Errors over what is held out: given model, plain fit and re-fitted baseline; the truth, and a fit from it."""

    given: Errors
    plain: Errors
    refit: Errors
    truth: Errors
    from_truth: Errors

    def over_the_plain_fit(self, seconds: float) -> float:
        """The re-fitted baseline's error over that of the plain fit."""
        return self.refit.at(seconds) / self.plain.at(seconds)

    def over_the_truth(self, seconds: float) -> float:
        """The error of what was fitted from the truth over that of the truth."""
        return self.from_truth.at(seconds) / self.truth.at(seconds)


def home(seed: int, *effects: str, duration_s: float = _DURATION_S) -> ConcealedCase:
    """A motor with `effects` of medium size, by the benchmark's first simulator."""
    return make_case(seed, effects=effects, size="medium" if effects else None, duration_s=duration_s)


def problem_of(made: ConcealedCase) -> Problem:
    """The problem that a diagnosis of the case would work on."""
    listed = made.content["recordings"]
    fitted = tuple(one for one in made.recordings if one.name in listed)
    held_out = tuple(one for one in made.recordings if one.name not in listed)
    return problem_for(Case(made.name, Path(), made.content["plant"], fitted, held_out, "a"))


def plain_fit(simulator: Simulator, problem: Problem) -> Plant:
    """The baseline, fitted by scipy on windows of all that is not held out."""
    held = {part.signals.name: part.counted for part in problem.held_out}
    shown = [
        np.isfinite(one.measured) & ~held.get(one.name, np.zeros(one.measured.size, dtype=bool))
        for one in problem.signals
    ]
    return fitted_on_windows(simulator, problem.plant, problem.signals, shown)


def consistency(made: ConcealedCase) -> Consistency:
    """Fit a case in three ways."""
    problem = problem_of(made)
    hidden = {effect["id"]: effect["params"] for effect in made.answer["effects"]}
    truth = plant_from_config({"kind": "dc_motor", **made.answer["base"], "effects": hidden}, "power_pct")
    with Simulator(problem.plant.layout) as simulator:
        fitter = Fitter(simulator, problem)
        found = settled(fitter, truth, first_guess(truth, problem.signals, problem.scale.torque))
        final = fit_everything(fitter, found.plant, found.noise)
        refit = best_baseline(fitter, settled_baseline(fitter), final)
        plants = (problem.plant, plain_fit(simulator, problem), refit.plant, truth, final.plant)
        return Consistency(
            *(errors_of(simulator, problem, plant, final.plant, final.noise) for plant in plants)
        )


def report(first: int = FIRST_SEED, count: int = SEEDS) -> Iterator[str]:
    """A line for each case, and how many keep the limits."""
    over_plain, over_truth = [], []
    yield "                              2 s: over the plain fit, over the truth; whole runs: likewise"
    for seed in range(first, first + count):
        for effect in EFFECTS:
            one = consistency(home(seed, effect))
            figures = [f(s) for s in (WINDOW_S, np.inf) for f in (one.over_the_plain_fit, one.over_the_truth)]
            over_plain.append(figures[0])
            over_truth.append(figures[1])
            yield f"seed {seed:4} {effect:18} " + "  ".join(f"{figure:5.2f}" for figure in figures)
    for name, values, most in (
        ("the plain fit", over_plain, MOST_OVER_THE_PLAIN_FIT),
        ("the truth", over_truth, MOST_OVER_THE_TRUTH),
    ):
        kept = sum(value <= most for value in values)
        yield f"within {most} times {name} in windows of 2 s: {kept} of {len(values)}"


if __name__ == "__main__":
    for line in report(*map(int, sys.argv[1:])):
        print(line, flush=True)
