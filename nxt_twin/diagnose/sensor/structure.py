"""A structure: which effects a sensor has, and its parameters at their likeliest."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.sensor.declaration import SensorEffect
from nxt_twin.diagnose.sensor.problem import ItemSplit, Mask, SensorProblem, Values, split_of
from nxt_twin.sensors.fitting import Free, climb, covariance_at, maximise
from nxt_twin.sensors.walk import walked

_STARTS_FOLLOWED = 3  # the likeliest, by gradient steps
_STEPS_TO_COMPARE = 15  # by gradient from each start, before the best is fitted to the end
_MOST_CORRELATED = 0.9  # correlation of neighbouring items, at most; larger ones count as this
_WALKERS, _STEPS = 24, 400
_BEGIN = 2.0  # times a change that matters: narrower crowds have not spread by the end, wider ones get lost


@final
@dataclass(frozen=True)
class SensorStructure:
    """Effects and values, fitted.

    Attributes:
        active: the effects in it, in the order in which they came in.
        values: of every field.
        names: the fields that were fitted.
        fit_nats, check_nats: log-likelihood of the fitted items (with the prior) and of those that check.
        independent: the share of the items that counts as independent, from what is left.
    """

    active: tuple[SensorEffect, ...]
    values: Values
    names: tuple[str, ...]
    fit_nats: float
    check_nats: float
    independent: float

    @property
    def ids(self) -> frozenset[str]:
        """The ids of its effects."""
        return frozenset(effect.id for effect in self.active)


@final
class SensorFitter:
    """Fits structures of one problem.

    Args:
        problem: the case.
        seed: of the tie-breaking in the residuals.
    """

    def __init__(self, problem: SensorProblem, seed: int) -> None:
        self.problem = problem
        self._seed = seed

    @cached_property
    def split(self) -> ItemSplit:
        """The items that are fitted, that check, and that are held out."""
        return split_of(self.problem)

    def baseline(self) -> SensorStructure:
        """The ideal sensor, re-fitted."""
        return self._finished((), self._fitted((), [self.problem.base_start()], self.split.fit))

    def with_effect(
        self, structure: SensorStructure, effect: SensorEffect, worth_nats: float = -np.inf
    ) -> SensorStructure | None:
        """The structure with one more effect; None if the data give no place to begin.

        Where gradient steps from the best starts do not bring the fitted items above `worth_nats`, they are left
        at that.
        """
        begin = self.problem.starts(effect, structure.values)
        if not begin:
            return None
        active = (*structure.active, effect)
        starts = [{**structure.values, **start} for start in begin]
        return self._finished(active, self._fitted(active, starts, self.split.fit, worth_nats))

    def without(self, structure: SensorStructure, effect: SensorEffect) -> SensorStructure:
        """The structure without one of its effects, fitted anew."""
        active = tuple(other for other in structure.active if other.id != effect.id)
        noise = {name: value for name, value in self.problem.base_start().items() if "noise" in name}
        off = {**structure.values, **self.problem.off(effect)}
        return self._finished(active, self._fitted(active, [off, {**off, **noise}], self.split.fit))

    def on_everything(self, structure: SensorStructure) -> SensorStructure:
        """The same structure fitted on all that is not held out."""
        values = self._fitted(structure.active, [structure.values], self.split.known)
        return self._finished(structure.active, values)

    def under_law(self, structure: SensorStructure, law: Values) -> tuple[SensorStructure, float]:
        """The structure under another of an effect's laws, and its nats on all that is not held out."""
        free = self._free(structure.active)
        values = self._best(free, [{**structure.values, **law}], self.split.known)
        nats = self._nats(values, free, np.array([values[part.name] for part in free]), self.split.known)
        return self._finished(structure.active, values), nats

    def wandered(self, structure: SensorStructure) -> tuple[Values, FloatArray]:
        """The mean of all likely values, and the covariance of the fitted ones, from a random walk among them."""
        free = self._free(structure.active)
        best = np.array([structure.values[part.name] for part in free])

        def nats(crowd: FloatArray) -> FloatArray:
            known = self.split.known
            return (
                np.array([self._nats(structure.values, free, x, known) for x in crowd])
                * structure.independent
            )

        # Not by the curvature, which tells nothing of a likelihood that goes in steps.
        spread = _BEGIN * np.array([part.scale for part in free])
        bounds = np.array([part.lower for part in free]), np.array([part.upper for part in free])
        rng = np.random.default_rng(self._seed)
        draws = walked(nats, best, spread, bounds, rng, walkers=_WALKERS, steps=_STEPS)
        return _moved(structure.values, free, draws.mean(axis=0)), np.atleast_2d(np.cov(draws.T))

    def covariance(self, structure: SensorStructure) -> FloatArray:
        """Of the fitted values on all that is not held out; shape (names, names)."""
        free = self._free(structure.active)
        x = np.array([structure.values[part.name] for part in free])
        plain = covariance_at(lambda y: self._nats(structure.values, free, y, self.split.known), x, free)
        return plain / structure.independent

    def learn_run(self, structure: SensorStructure, run: int, items: Mask) -> Values:
        """The values with what belongs to one run taken from `items` of it, all else left alone."""
        own = self.problem.run_bound(run)
        templates = [part for effect in structure.active for part in self.problem.free(effect)]
        marks = {part.name.split("@")[0]: part for part in templates if "@" in part.name}
        free = [
            Free(name, marks[mark].lower, marks[mark].upper, marks[mark].scale)
            for name in sorted(own)
            if (mark := name.split("@")[0]) in marks
        ]
        if not free:
            return structure.values
        starts = [structure.values]
        for effect in structure.active:
            begins = [
                {name: value for name, value in begin.items() if name in own}
                for begin in self.problem.starts(effect, structure.values)
            ]
            starts += [{**structure.values, **begin} for begin in begins if begin]
        phases = [part.name for part in free if part.name.startswith("phase")]
        starts += [
            {**start, **dict.fromkeys(phases, turn)}
            for start in starts
            for turn in (1.57, 3.14, 4.71)
            if phases
        ]
        return self._best(free, starts, items)

    def _fitted(
        self,
        active: Sequence[SensorEffect],
        starts: Iterable[Values],
        mask: Mask,
        worth_nats: float = -np.inf,
    ) -> Values:
        return self._best(self._free(active), starts, mask, worth_nats)

    def _best(
        self, free: Sequence[Free], starts: Iterable[Values], mask: Mask, worth_nats: float = -np.inf
    ) -> Values:
        """The likeliest values, from the starts that are likeliest before fitting."""

        def standing(start: Values) -> float:
            x = np.array([start[part.name] for part in free])
            return self._nats(start, free, x, mask)

        def objective(start: Values) -> Callable[[FloatArray], float]:
            return lambda x: self._nats(start, free, x, mask)

        promising = sorted(starts, key=standing, reverse=True)[:_STARTS_FOLLOWED]
        ends = []
        for start in promising:
            x0 = np.array([start[part.name] for part in free])
            x = climb(objective(start), x0, free, _STEPS_TO_COMPARE)
            ends.append((objective(start)(x), start, x))
        nats, start, x = max(ends, key=lambda end: end[0])
        if nats < worth_nats:
            return _moved(start, free, x)
        return _moved(start, free, maximise(objective(start), x, free))

    def _nats(self, values: Values, free: Sequence[Free], x: FloatArray, mask: Mask) -> float:
        moved = _moved(values, free, x)
        return float(np.sum(self.problem.log_each(moved)[mask])) + self.problem.log_prior(moved)

    def _free(self, active: Sequence[SensorEffect]) -> list[Free]:
        replaced = {name for effect in active for name in effect.replaces}
        base = [part for part in self.problem.base() if part.name not in replaced]
        return [*base, *(part for effect in active for part in self.problem.free(effect))]

    def _finished(self, active: Sequence[SensorEffect], values: Values) -> SensorStructure:
        each = self.problem.log_each(values)
        names = tuple(part.name for part in self._free(active))
        return SensorStructure(
            active=tuple(active),
            values=values,
            names=names,
            fit_nats=float(np.sum(each[self.split.fit])) + self.problem.log_prior(values),
            check_nats=float(np.sum(each[self.split.check])),
            independent=self._independent(values),
        )

    def _independent(self, values: Values) -> float:
        """The effective share of items, (1 - r) / (1 + r) for a correlation r of neighbours."""
        scores = self.scores(values)
        neighbours = np.diff(self.problem.item_run) == 0
        pair = neighbours & np.isfinite(scores[1:]) & np.isfinite(scores[:-1])
        if np.count_nonzero(pair) < 20:
            return 1.0
        first, second = (np.clip(part, -4.0, 4.0)[pair] for part in (scores[:-1], scores[1:]))
        correlation = float(np.mean(first * second) / max(np.mean(first**2), 1e-9))
        doubt = 2.0 / np.sqrt(np.count_nonzero(pair))
        correlation = float(np.clip(correlation - doubt, 0.0, _MOST_CORRELATED))
        return (1.0 - correlation) / (1.0 + correlation)

    def scores(self, values: Values) -> FloatArray:
        """Residuals that are standard normal if the values are right, shape (items,)."""
        return self.problem.scores(values, np.random.default_rng(self._seed))


def _moved(values: Values, free: Sequence[Free], x: FloatArray) -> Values:
    return {**values, **{part.name: float(value) for part, value in zip(free, x, strict=True)}}
