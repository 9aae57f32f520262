"""Whether what is fitted also simulates: errors in windows of 2 s and over whole runs of what no fit saw.

`python -m benchmarks.consistency 21 8 bristle,stiff 12` takes seeds 21 to 28 of these truth families, 12 s a
recording. Each seed gives a motor with play and one with a shaft that twists. The command prints the error of the re-
fitted baseline over that of a plain fit of windows by scipy. Beside it stand two fits of the true structure. The one
from the true parameters is held against the true parameters themselves, and the one from the baseline against the fit
from the truth.

A fit that leaves the truth is explained by one of two things. Scipy's plain fit of the true structure, started at the
truth too, may leave it as far: then it is the data. Or the held-out recordings drive the motor in a way that no fitted
one does, such as coasting.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import final

import numpy as np

from benchmarks.plain_windows import FREE, WINDOW_S, fitted_on_windows
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
from nxt_twin.physics.layout import Slot
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
    `plain_truth` is scipy's fit of the true structure from the true parameters. `fitted_better` is the error of the
    true parameters over that of the fit from them, on fitted readings. Where the simulator has other equations than
    the engine, other parameters are the better ones. `unseen_s` is how long held-out commands drive the motor in a
    mode that no fitted one has.
    """

    tolerance: float

    given: Errors
    plain: Errors
    refit: Errors
    truth: Errors
    from_truth: Errors
    from_baseline: Errors
    plain_truth: Errors
    fitted_better: float
    unseen_s: float

    def over_the_plain_fit(self, seconds: float) -> float:
        """The re-fitted baseline's error over that of the plain fit."""
        return self._over(self.refit, self.plain, seconds)

    def over_the_truth(self, seconds: float) -> float:
        """The error of what was fitted from the truth over that of the truth."""
        return self._over(self.from_truth, self.truth, seconds)

    def over_the_plain_truth(self, seconds: float) -> float:
        """The error of what was fitted from the truth over that of scipy's fit from there."""
        return self._over(self.from_truth, self.plain_truth, seconds)

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
    ("scipy's from the truth", MOST_OVER_THE_TRUTH, Consistency.over_the_plain_truth),
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


def plain_fit(simulator: Simulator, problem: Problem, plant: Plant | None = None) -> Plant:
    """The baseline or another plant, fitted by scipy on windows of all that is not held out."""
    held = {part.signals.name: part.counted for part in problem.held_out}
    shown = [
        np.isfinite(one.measured) & ~held.get(one.name, np.zeros(one.measured.size, dtype=bool))
        for one in problem.signals
    ]
    begun = problem.plant if plant is None else plant
    own = [
        Slot(effect.id, parameter.symbol)
        for effect in begun.effects
        if effect.id in EFFECTS
        for parameter in effect.parameters
        if begun.values[Slot(effect.id, parameter.symbol)] > 0.0
    ]
    return fitted_on_windows(simulator, begun, problem.signals, shown, (*FREE, *own))


def unseen_seconds(problem: Problem) -> float:
    """How long held-out commands drive the motor in a mode that no fitted command has, s."""
    held = {part.signals.name: part.signals for part in problem.held_out}
    fitted = {int(m) for one in problem.signals if one.name not in held for m in one.command_mode}
    return float(
        sum(
            np.diff(one.command_time_s, append=one.time_s[-1])[~np.isin(one.command_mode, list(fitted))].sum()
            for one in held.values()
            if fitted
        )
    )


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
        plains = (plain_fit(simulator, problem), plain_fit(simulator, problem, truth))
        plants = (problem.plant, plains[0], refit.plant, truth, final.plant, other.plant, plains[1])
        fitted = [fitter.simulated_error(plant, final.noise) for plant in (truth, final.plant)]
        given, plain, best, true, from_truth, from_baseline, plain_truth = (
            errors_of(simulator, problem, plant, final.plant, final.noise) for plant in plants
        )
        return Consistency(
            problem.tolerance,
            given=given,
            plain=plain,
            refit=best,
            truth=true,
            from_truth=from_truth,
            from_baseline=from_baseline,
            plain_truth=plain_truth,
            fitted_better=fitted[0] / fitted[1],
            unseen_s=unseen_seconds(problem),
        )


def report(
    first: int = FIRST_SEED, count: int = SEEDS, families: str = BRISTLE, duration_s: float = _DURATION_S
) -> Iterator[str]:
    """A line for each case, and how many of each family keep the limits."""
    yield f"{'':36} " + "  ".join(f"{words:>22}" for words, _, _ in LIMITS) + "   (2 s, whole runs)"
    found: dict[str, list[Consistency]] = {}
    for family in families.split(","):
        for seed in range(first, first + count):
            for effect in EFFECTS:
                one = consistency(home(seed, effect, family=family, duration_s=duration_s))
                found.setdefault(family, []).append(one)
                cells = [f"{over(one, WINDOW_S):10.2f}, {over(one, np.inf):10.2f}" for _, _, over in LIMITS]
                told = f"  fitted readings {one.fitted_better:.2f} times nearer than by the truth"
                told += f", {one.unseen_s:.1f} s in modes that are held out alone" if one.unseen_s else ""
                yield f"{family:9} seed {seed:4} {effect:16} " + "  ".join(cells) + told
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
    """First seed, number of seeds, families with commas between, and the length of a recording, s."""
    usual = (str(FIRST_SEED), str(SEEDS), BRISTLE, str(_DURATION_S))
    first, count, families, duration_s = (*arguments, *usual[len(arguments) :])
    for line in report(int(first), int(count), families, float(duration_s)):
        print(line, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
