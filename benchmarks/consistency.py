"""Whether what is fitted also simulates: errors in windows of 2 s and over whole runs of what no fit saw.

`python -m benchmarks.consistency 21 8 bristle,stiff` takes seeds 21 to 28 of these truth families: a motor with play
and one with a shaft that twists, each. It prints the error of the re-fitted baseline over that of a plain fit of
windows by scipy. Beside it stand two fits of the true structure. The one from the true parameters is held against the
true parameters themselves, and the one from the baseline against the fit from the truth.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import final

import numpy as np

from benchmarks.plain_windows import WINDOW_S, fitted_on_windows
from nxt_twin.blind.case import ConcealedCase
from nxt_twin.blind.families.family import Order
from nxt_twin.blind.families.table import BRISTLE, FAMILIES
from nxt_twin.blind.make import write_case
from nxt_twin.blind.sets import CasePlan
from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting.baselines import best_baseline, settled_baseline
from nxt_twin.diagnose.fitting.drafting import drafted
from nxt_twin.diagnose.fitting.everything import fit_everything
from nxt_twin.diagnose.fitting.fitter import SETTLED, Fitter
from nxt_twin.diagnose.fitting.noise import first_noise
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.settling import settled
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.fitting.variables import starts_of
from nxt_twin.diagnose.judging.horizons import Errors, errors_of
from nxt_twin.physics.plant import Plant, plant_from_config
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.case import read_case

EFFECTS = ("backlash", "shaft_compliance")
FIRST_SEED, SEEDS = 21, 8
MOST_OVER_THE_PLAIN_FIT = 1.1
MOST_OVER_THE_TRUTH = 1.2
_DURATION_S = 12.0
_DRAFT_ITERATIONS = 12
_FOLLOWED = 3  # starts of an effect that are settled, as the search does


@final
@dataclass(frozen=True)
class Consistency:
    """Errors over what is held out.

    Of the given model, a plain fit and the re-fitted baseline. Of the true parameters, and of fits of the true
    structure from them and from the baseline. An error below `tolerance`, which does not matter, counts as that.
    `fitted_better` is the error of the true parameters over that of the fit from them, on fitted readings. Where the
    simulator has other equations than the engine, other parameters are the better ones.
    """

    tolerance: float

    given: Errors
    plain: Errors
    refit: Errors
    truth: Errors
    from_truth: Errors
    from_baseline: Errors
    fitted_better: float

    def over_the_plain_fit(self, seconds: float) -> float:
        """The re-fitted baseline's error over that of the plain fit."""
        return self._over(self.refit, self.plain, seconds)

    def over_the_truth(self, seconds: float) -> float:
        """The error of what was fitted from the truth over that of the truth."""
        return self._over(self.from_truth, self.truth, seconds)

    def over_the_fit_from_the_truth(self, seconds: float) -> float:
        """The error of what was fitted from the baseline over that of what was fitted from the truth."""
        return self._over(self.from_baseline, self.from_truth, seconds)

    def leaves_the_truth(self, seconds: float) -> bool:
        """Whether the fit from the truth is worse than that, though fitted readings do not call for it."""
        return self.over_the_truth(seconds) > MOST_OVER_THE_TRUTH and self.fitted_better <= 1.0

    def _over(self, one: Errors, other: Errors, seconds: float) -> float:
        return max(one.at(seconds), self.tolerance) / max(other.at(seconds), self.tolerance)


LIMITS: tuple[tuple[str, float, Callable[[Consistency, float], float]], ...] = (
    ("the plain fit", MOST_OVER_THE_PLAIN_FIT, Consistency.over_the_plain_fit),
    ("the truth", MOST_OVER_THE_TRUTH, Consistency.over_the_truth),
    ("the fit from the truth", MOST_OVER_THE_TRUTH, Consistency.over_the_fit_from_the_truth),
)


def home(seed: int, *effects: str, duration_s: float = _DURATION_S, family: str = BRISTLE) -> ConcealedCase:
    """A motor of a family with `effects` of medium size, by default of the benchmark's first simulator."""
    plan = CasePlan(f"{family}-{seed}", seed, effects, "medium" if effects else None)
    return FAMILIES[family].make(Order(family, plan, "usb", duration_s))


def problem_of(made: ConcealedCase) -> Problem:
    """The problem that a diagnosis of the case would work on."""
    with TemporaryDirectory() as folder:
        return problem_for(read_case(write_case(made, Path(folder) / "cases", Path(folder) / "answers")))


def plain_fit(simulator: Simulator, problem: Problem) -> Plant:
    """The baseline, fitted by scipy on windows of all that is not held out."""
    held = {part.signals.name: part.counted for part in problem.held_out}
    shown = [
        np.isfinite(one.measured) & ~held.get(one.name, np.zeros(one.measured.size, dtype=bool))
        for one in problem.signals
    ]
    return fitted_on_windows(simulator, problem.plant, problem.signals, shown)


def fitted_from(fitter: Fitter, baseline: Structure, effects: Sequence[str]) -> Structure:
    """The baseline with effects, one after the other, each the likeliest from the library's best starting values."""
    found = baseline
    for name in effects:
        effect = found.plant.layout.effect(name)
        starts = [found.plant.with_effect(name, start) for start in starts_of(effect, fitter.problem.scale)]
        drafts = [drafted(fitter, one, found.noise, iterations=_DRAFT_ITERATIONS) for one in starts]
        followed = sorted(drafts, key=lambda draft: draft.cost)[:_FOLLOWED]
        fits = [
            fitter.fit(draft.fitted.plant, found.noise, replace(SETTLED, iterations=25))[0]
            for draft in followed
        ]
        tried = [settled(fitter, fitted.plant, found.noise) for fitted in fits]
        found = min(tried, key=lambda structure: structure.fitted_cost)
    return fit_everything(fitter, found.plant, found.noise)


def consistency(made: ConcealedCase) -> Consistency:
    """Fit a case in four ways."""
    problem = problem_of(made)
    hidden = {effect["id"]: effect["params"] for effect in made.answer["effects"]}
    truth = plant_from_config({"kind": "dc_motor", **made.answer["base"], "effects": hidden}, "power_pct")
    with Simulator(problem.plant.layout) as simulator:
        fitter = Fitter(simulator, problem)
        found = settled(fitter, truth, first_noise(truth, problem.signals, problem.scale.torque))
        final = fit_everything(fitter, found.plant, found.noise)
        baseline = settled_baseline(fitter)
        refit = best_baseline(fitter, baseline, final)
        other = fitted_from(fitter, baseline, tuple(hidden))
        plants = (problem.plant, plain_fit(simulator, problem), refit.plant, truth, final.plant, other.plant)
        fitted = [fitter.simulated_error(plant, final.noise) for plant in (truth, final.plant)]
        return Consistency(
            problem.tolerance,
            *(errors_of(simulator, problem, plant, final.plant, final.noise) for plant in plants),
            fitted_better=fitted[0] / fitted[1],
        )


def report(first: int = FIRST_SEED, count: int = SEEDS, families: str = BRISTLE) -> Iterator[str]:
    """A line for each case, and how many of each family keep the limits."""
    yield f"{'':36} " + "  ".join(f"{words:>22}" for words, _, _ in LIMITS) + "   (2 s, whole runs)"
    found: dict[str, list[Consistency]] = {}
    for family in families.split(","):
        for seed in range(first, first + count):
            for effect in EFFECTS:
                one = consistency(home(seed, effect, family=family))
                found.setdefault(family, []).append(one)
                cells = [f"{over(one, WINDOW_S):10.2f}, {over(one, np.inf):10.2f}" for _, _, over in LIMITS]
                fitted = f"  fitted readings {one.fitted_better:.2f} times nearer than by the truth"
                yield f"{family:9} seed {seed:4} {effect:16} " + "  ".join(cells) + fitted
    for family, own in found.items():
        for words, most, over in LIMITS:
            kept = [sum(over(one, seconds) <= most for one in own) for seconds in (WINDOW_S, np.inf)]
            yield f"{family}: within {most} times {words}: {kept[0]} of {len(own)} at 2 s, {kept[1]} over whole runs"
        for words, _, over in LIMITS:
            means = [
                np.exp(np.mean([np.log(over(one, seconds)) for one in own])) for seconds in (WINDOW_S, np.inf)
            ]
            yield f"{family}: over {words}, geometric mean: {means[0]:.2f} at 2 s, {means[1]:.2f} over whole runs"
        left = [sum(one.leaves_the_truth(seconds) for one in own) for seconds in (WINDOW_S, np.inf)]
        yield f"{family}: leaves the truth though fitted readings do not call for it: {left[0]} and {left[1]}"


def main(arguments: Sequence[str]) -> None:
    """First seed, number of seeds, families with commas between."""
    numbers, families = [int(one) for one in arguments[:2]], arguments[2:]
    for line in report(*numbers, *families):
        print(line, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
