"""The smallest size of each effect that these recordings would have shown."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.batch import batches
from nxt_twin.diagnose.fitting.linear import Linear, Trial, signatures
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.variables import starts_of
from nxt_twin.diagnose.search.limits import LIMITS
from nxt_twin.diagnose.search.trials import addable_effects
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.parameter import Scale
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Simulator

_FACTORS = (1.0 / 32.0, 1.0 / 6.0, 1.0, 6.0)
_NINE_OF_TEN = 1.2816  # standard deviations: a normal variable stays below nine times of ten


@final
@dataclass(frozen=True)
class Detectable:
    """The smallest size at which an effect is found.

    Attributes:
        effect: the effect.
        size: of its main parameter, SI, found nine times of ten; None where an ordinary size six times over
            would not be.
        seen_above: larger is easier to see; a current limit or a stiffness is the other way round.
        difference: the size is what separates the first parameter from the second (friction by direction).
    """

    effect: Effect
    size: float | None
    seen_above: bool
    difference: bool


def needed_nats(effect: Effect, readings: int) -> tuple[float, float]:
    """Mean gain in fitted and in check readings, from which a search accepts an effect nine times of ten."""
    penalty = 0.5 * max(len(effect.parameters) - len(effect.supersedes), 1) * math.log(max(readings, 2))
    fitted = 0.5 * (math.sqrt(2.0 * (LIMITS.gain_nats + penalty)) + _NINE_OF_TEN) ** 2
    checked = 0.5 * (_NINE_OF_TEN + math.sqrt(_NINE_OF_TEN**2 + 2.0 * LIMITS.check_nats)) ** 2
    return fitted, checked


def allowed(problem: Problem, plant: Plant) -> list[Effect]:
    """Effects that could be added to `plant` and whose trace is in the readings' values."""
    return [e for e in addable_effects(plant, problem.signals[0]) if "outlier" not in e.terms]


def detectable(simulator: Simulator, problem: Problem, linear: Linear) -> tuple[Detectable, ...]:
    """The smallest size of each effect that could be added, from what the re-fit cannot take up of its signature."""
    plant = linear.structure.plant
    effects = allowed(problem, plant)
    trials = [trial_of(effect, plant, problem.scale, factor) for effect in effects for factor in _FACTORS]
    shown = _shown(simulator, linear, trials)
    curves = np.log(np.maximum(shown.reshape(len(effects), len(_FACTORS)), 1e-12))
    logs = np.log(_FACTORS)
    guesses = [_crossing(logs, curve) for curve in curves]
    again = [n for n, guess in enumerate(guesses) if guess is not None]
    finer = [trial_of(effects[n], plant, problem.scale, math.exp(guesses[n] or 0.0)) for n in again]
    refined = np.log(np.maximum(_shown(simulator, linear, finer), 1e-12))
    for n, level in zip(again, refined, strict=True):
        at = np.append(logs, guesses[n] or 0.0)
        order = np.argsort(at)
        guesses[n] = _crossing(at[order], np.append(curves[n], level)[order])
    return tuple(
        _as_found(effect, plant, problem.scale, guess, seen_above=_seen_above(effect, curve))
        for effect, guess, curve in zip(effects, guesses, curves, strict=True)
    )


def trial_of(effect: Effect, plant: Plant, scale: Scale, factor: float) -> Trial:
    """`effect` at `factor` times its ordinary size; one that replaces a plain term leans round that term's value."""
    start = starts_of(effect, scale)[0]
    main, *others = effect.parameters
    if effect.supersedes and others:
        middle = _replaced(effect, plant)
        lean = 0.5 * factor * abs(start[main.symbol] - start[others[0].symbol])
        return Trial(effect, {**start, main.symbol: middle + lean, others[0].symbol: max(middle - lean, 0.0)})
    neutral = effect.neutral * main.si
    size = neutral + factor * (start[main.symbol] - neutral)
    bounds = main.in_frame(plant.layout.frame).scaled(scale)
    return Trial(
        effect, {**start, main.symbol: min(max(size, bounds.lower * main.si), bounds.upper * main.si)}
    )


def _replaced(effect: Effect, plant: Plant) -> float:
    """The mean value of the plain terms that `effect` supersedes, 0 where the plant has none."""
    values = [value for slot, value in plant.values.items() if slot.owner in effect.supersedes]
    return float(np.mean(values)) if values else 0.0


def _shown(simulator: Simulator, linear: Linear, trials: Sequence[Trial]) -> FloatArray:
    """Expected nats of each trial over those needed, the lesser of fitted and checking readings."""
    fitted = ~linear.checks
    readings = max(int(fitted.sum()), 2)
    shown = np.zeros(len(trials))
    for part in batches(len(trials), linear.innovations.size):
        found = signatures(simulator, linear, linear.structure.plant, trials[part])
        left = linear.left_of(found, fitted)
        in_fitted = 0.5 * np.sum(found[:, fitted] * left[:, fitted], axis=1)
        in_checks = 0.5 * np.sum(left[:, ~fitted] ** 2, axis=1)
        needed = np.array([needed_nats(trial.effect, readings) for trial in trials[part]])
        shown[part] = np.minimum(in_fitted / needed[:, 0], in_checks / needed[:, 1])
    return shown


def _crossing(logs: FloatArray, curve: FloatArray) -> float | None:
    """Where `curve` first rises through 0, seen from its weak end; below the smallest factor by the square law."""
    if curve[-1] < curve[0]:
        found = _crossing(-logs[::-1], curve[::-1])
        return None if found is None else -found
    above = np.flatnonzero(curve >= 0.0)
    if above.size == 0:
        return None
    k = int(above[0])
    if k == 0:
        return float(logs[0] - 0.5 * curve[0])
    share = -curve[k - 1] / max(curve[k] - curve[k - 1], 1e-12)
    return float(logs[k - 1] + share * (logs[k] - logs[k - 1]))


def _seen_above(effect: Effect, curve: FloatArray) -> bool:
    """Whether a larger main parameter shows better; `curve` is over its distance from where it does nothing."""
    below = effect.neutral > effect.parameters[0].starts[0]
    return bool(curve[-1] >= curve[0]) != below


def _as_found(
    effect: Effect, plant: Plant, scale: Scale, log_factor: float | None, *, seen_above: bool
) -> Detectable:
    difference = bool(effect.supersedes) and len(effect.parameters) > 1
    if log_factor is None:
        return Detectable(effect, None, seen_above, difference)
    trial = trial_of(effect, plant, scale, math.exp(log_factor))
    if difference and _replaced(effect, plant) > 0.0 >= trial.values[effect.parameters[1].symbol]:
        return Detectable(effect, None, seen_above, difference)  # all of the friction is no lean of it
    size = trial.size - trial.values[effect.parameters[1].symbol] if difference else trial.size
    return Detectable(effect, abs(size), seen_above, difference)
