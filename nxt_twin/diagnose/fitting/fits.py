"""All that a search asks of fits, in one place: no other file of this room is called from there."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TypeVar, final

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.baselines import best_baseline, likely_baseline, settled_baseline, standing
from nxt_twin.diagnose.fitting.drafting import (
    check_costs,
    costs_everywhere,
    costs_of_each,
    draft_cost,
    draft_costs,
    drafted,
)
from nxt_twin.diagnose.fitting.everything import fit_everything
from nxt_twin.diagnose.fitting.fitter import DRAFTED, SETTLED, Fitter
from nxt_twin.diagnose.fitting.lateness import lateness_s
from nxt_twin.diagnose.fitting.moments import gained_elsewhere, moments_gained
from nxt_twin.diagnose.fitting.noise import first_noise
from nxt_twin.diagnose.fitting.nuisance import Nuisance
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.promised import promised
from nxt_twin.diagnose.fitting.settling import settled
from nxt_twin.diagnose.fitting.structure import Draft, Structure
from nxt_twin.diagnose.fitting.variables import starts_of
from nxt_twin.diagnose.fitting.wandering import (
    late_by_chance_starts,
    second_wave_alone,
    second_waves,
    wandering_apart_starts,
    wandering_starts,
)
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Simulator

ItemT = TypeVar("ItemT")
ResultT = TypeVar("ResultT")


@final
class Fits:
    """Plants fitted to the readings of one problem, roughly or closely.

    Attributes:
        problem: the readings, the given plant and the tolerance.
    """

    def __init__(self, simulator: Simulator, problem: Problem) -> None:
        self.problem = problem
        self._fitter = Fitter(simulator, problem)

    def abreast(self, function: Callable[[ItemT], ResultT], items: Iterable[ItemT]) -> list[ResultT]:
        """What `function`, which makes fits, gives for each of `items`, which do not depend on one another."""
        return self._fitter.simulator.abreast(function, items)

    def first_noise(self) -> Noise:
        """Noise of the given plant to start a search from."""
        return first_noise(self.problem.plant, self.problem.signals, self.problem.scale.torque)

    def starts(self, effect: Effect) -> list[dict[str, float]]:
        """Every combination of starting values of `effect`, SI by symbol; the typical one first."""
        return starts_of(effect, self.problem.scale)

    def starts_beside(self, structure: Structure, effect: Effect) -> list[dict[str, float]]:
        """As `starts`, with what the residuals of `structure` suggest beside them."""
        if "pace" not in effect.terms:
            return self.starts(effect)
        return self.starts(effect) + wandering_starts(self._nuisance(structure), structure.plant, effect)

    def wandering_apart(
        self, structure: Structure, effect: Effect
    ) -> list[tuple[Plant, Mapping[str, float]]]:
        """The plant of `structure` with starts of a lag that wanders, each with its phase in each fitted recording."""
        plant = structure.plant
        starts = wandering_apart_starts(self._nuisance(structure), plant, effect)
        return [(plant.with_effect(effect.id, start), phases) for start, phases in starts]

    def stamped_late(self, plant: Plant, effect: Effect) -> list[Plant]:
        """`plant` with rows as late as their neighbours tell, with their commands or without; none where none is."""
        span_s = max(signals.late_span_s for signals in self.problem.signals)
        starts = late_by_chance_starts(span_s) if "pace" in effect.terms else []
        by_commands = {start["of_commands"]: start for start in reversed(starts)}
        return [plant.with_effect(effect.id, start) for start in by_commands.values()]

    def second_waves(self, structure: Structure, effect: Effect) -> list[tuple[float, Plant]]:
        """The plant of `structure`, whose `effect` is one wave, with second ones and the gain that each promises."""
        return second_waves(self._nuisance(structure), structure.plant, effect)

    def second_wave_alone(self, plant: Plant, effect: Effect) -> Plant | None:
        """`plant` with the second wave of `effect` alone, where that is a large one."""
        return second_wave_alone(plant, effect)

    def _nuisance(self, structure: Structure) -> Nuisance:
        target = self._fitter.tuned(structure.noise, DRAFTED.step_for(structure.plant)).telling()
        return Nuisance(self._fitter, structure, target)

    def promised(self, structure: Structure, plants: Sequence[Plant]) -> list[tuple[int, float, float]]:
        """Of each plant its place in `plants`, the gain over `structure` that it promises, nats, and its stretch."""
        return promised(self._fitter, structure, plants)

    def costs(self, plants: Sequence[Plant], noise: Noise) -> FloatArray:
        """Of the fitted readings under plants with equal effects as they stand, nats, shape (plants,)."""
        return draft_costs(self._fitter, plants, noise)

    def check_costs(self, plants: Sequence[Plant], noise: Noise) -> FloatArray:
        """As `costs`, of the checking readings."""
        return check_costs(self._fitter, plants, noise)

    def costs_everywhere(self, plants: Sequence[Plant], noise: Noise) -> FloatArray:
        """As `costs`, of fitted and checking readings together."""
        return costs_everywhere(self._fitter, plants, noise)

    def costs_of_each(self, plants: Sequence[Plant], noise: Noise) -> dict[str, FloatArray]:
        """As `costs_everywhere`, of each recording by name; of one that is held out, of all its readings."""
        return costs_of_each(self._fitter, plants, noise)

    def draft(self, plant: Plant, noise: Noise, *, iterations: int) -> Draft:
        """`plant` fitted roughly under `noise`, on coarse steps."""
        return drafted(self._fitter, plant, noise, iterations=iterations)

    def drafted_cost(self, structure: Structure, noise: Noise) -> float:
        """As `Draft.cost`, of a structure as it stands, under other noise."""
        fitted, check = draft_cost(self._fitter, structure.plant, noise, DRAFTED.step_for(structure.plant))
        return fitted + structure.fitted.prior_cost + check

    def settled(self, plant: Plant, noise: Noise) -> Structure:
        """`plant` under the noise that suits it best, both searched from the given ones."""
        return settled(self._fitter, plant, noise)

    def settled_cost(self, plant: Plant, noise: Noise) -> float:
        """Of the fitted readings under `plant` as it stands, by the steps of a settled structure, nats."""
        return draft_cost(self._fitter, plant, noise, SETTLED.step_for(plant))[0]

    def settled_baseline(self) -> Structure:
        """The given plant, fitted and settled from a first guess of the noise."""
        return settled_baseline(self._fitter)

    def moments_gained(self, simpler: Structure, richer: Structure) -> float:
        """In how many moments, of a second each, `richer` gains what it gains, were they all to gain alike."""
        return moments_gained(self._fitter, simpler, richer)

    def gained_elsewhere(self, simpler: Structure, richer: Structure) -> float:
        """What `richer` gains in all seconds but the one in which it gains most, nats."""
        return gained_elsewhere(self._fitter, simpler, richer)

    def lateness_s(self, structure: Structure) -> float:
        """The mean age of the readings that `structure` doubts, s."""
        return lateness_s(self._fitter, structure)

    def everything(self, plant: Plant, noise: Noise) -> Structure:
        """`plant` fitted on all that is not held out, to the last digit."""
        return fit_everything(self._fitter, plant, noise)

    def simulated_error(self, plant: Plant, noise: Noise) -> float:
        """The mean error of all windows of simulation over all that is not held out, SI."""
        return self._fitter.simulated_error(plant, noise)

    def best_baseline(self, baseline: Structure, final: Structure) -> Structure:
        """The re-fitted baseline that simulates best, of fits under the noise of `baseline` and of `final`."""
        return best_baseline(self._fitter, baseline, final)

    def likely_baseline(self, baseline: Structure, final: Structure) -> Structure:
        """The re-fitted baseline where nothing was found: `final`, or a plain fit that simulates clearly nearer."""
        return likely_baseline(self._fitter, baseline, final)

    def as_given(self, noise: Noise) -> Structure:
        """The given plant with its parameters as they came."""
        return standing(self._fitter, self.problem.plant, noise)

    def standing(self, plant: Plant, noise: Noise) -> Structure:
        """`plant` as it stands."""
        return standing(self._fitter, plant, noise)
