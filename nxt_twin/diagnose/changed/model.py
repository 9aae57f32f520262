"""One plant on both sides but for what differs: a shared vector, differences after, and effects after."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.fitting.fit import Variable
from nxt_twin.diagnose.fitting.variables import variables_of
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.parameter import Scale
from nxt_twin.physics.plant import Plant

_LEAST_SHARE = 1e-3  # of its scale: the least value of a positive variable
_LARGEST_FACTOR = 30.0
_MOTOR = frozenset({"resistance", "torque_constant"})
_MOTOR_SPREAD = 0.2  # of the logarithm: a motor's constants hardly change while somebody works at the load
_SPREAD = 1.0


def is_motor_constant(slot: Slot) -> bool:
    """Whether it belongs to the motor itself rather than to what it moves."""
    return slot.symbol in _MOTOR


@final
@dataclass(frozen=True)
class Model:
    """What is shared and what differs.

    Attributes:
        plant: as it came; the parameters that no fit moves are taken from it.
        shared: variables of both sides.
        differs: indices into `shared` of those that have another value after.
        effects: ids of effects that act after and not before.
        after: `plant` with these effects, at their starts.
        added: variables of these effects.
    """

    plant: Plant
    shared: tuple[Variable, ...]
    differs: tuple[int, ...]
    effects: tuple[str, ...]
    after: Plant
    added: tuple[Variable, ...]

    @property
    def size(self) -> int:
        """How many numbers a fit of it moves."""
        return len(self.shared) + len(self.differs) + len(self.added)

    @property
    def changes(self) -> int:
        """How many parameters and effects differ."""
        return len(self.differs) + len(self.effects)

    @property
    def motor_constants(self) -> int:
        """How many of the motor's own constants differ."""
        return sum(is_motor_constant(self.shared[n].slots[0]) for n in self.differs)

    def differing(self, indices: Sequence[int]) -> Model:
        """With more variables that differ, in the order of `shared`."""
        return replace(self, differs=tuple(sorted({*self.differs, *indices})))

    def alike(self, index: int) -> Model:
        """With a variable that differs no longer."""
        return replace(self, differs=tuple(n for n in self.differs if n != index))

    def with_effect(self, effect_id: str, values: dict[str, float], scale: Scale) -> Model:
        """With one more effect after, from these starting values (SI, by symbol)."""
        return self._effects(self.after.with_effect(effect_id, values), (*self.effects, effect_id), scale)

    def lacking(self, effect_id: str, values: dict[str, float], scale: Scale) -> Model:
        """With one more effect on both sides, and none after alone."""
        plant = self.plant.with_effect(effect_id, values)
        variables = variables_of(plant, self.plant, scale)
        kept = {self.shared[n].slots[0] for n in self.differs}
        differs = tuple(n for n, variable in enumerate(variables) if variable.slots[0] in kept)
        bare = Model(plant, variables, differs, (), plant, ())
        for each in self.effects:
            own = {slot.symbol: v for slot, v in self.after.values.items() if slot.owner == each}
            bare = bare.with_effect(each, own, scale)
        return bare

    def without_effect(self, effect_id: str, scale: Scale) -> Model:
        """With an effect less after; what it superseded comes back."""
        after = self.plant
        kept = tuple(each for each in self.effects if each != effect_id)
        for each in kept:
            own = {slot.symbol: v for slot, v in self.after.values.items() if slot.owner == each}
            after = after.with_effect(each, own)
        return self._effects(after, kept, scale)

    def _effects(self, after: Plant, effects: tuple[str, ...], scale: Scale) -> Model:
        every = variables_of(after, self.plant, scale)
        added = tuple(v for v in every if v.slots[0].owner in effects)
        return replace(self, after=after, effects=effects, added=added)

    def start(self) -> FloatArray:
        """The plant as it came, nothing different, effects at their starts."""
        own = [inside(v, self.plant.values[v.slots[0]]) for v in self.shared]
        new = [inside(v, self.after.values[v.slots[0]]) for v in self.added]
        return np.array([*own, *([0.0] * len(self.differs)), *new])

    def moved_from(self, other: Model, x: FloatArray) -> FloatArray:
        """Where `other` stood at `x`, in this model's numbers; what it did not have is at its start."""
        known = dict(zip(other.names(), x, strict=True))
        return np.array([known.get(*each) for each in zip(self.names(), self.start(), strict=True)])

    def names(self) -> list[tuple[str, Slot]]:
        """What each number is of: shared, different or added, and of which parameter."""
        slots = [variable.slots[0] for variable in self.shared]
        return [
            *(("shared", slot) for slot in slots),
            *(("differs", slots[n]) for n in self.differs),
            *(("added", variable.slots[0]) for variable in self.added),
        ]

    def priors(self) -> tuple[FloatArray, FloatArray]:
        """Means and standard deviations, inside."""
        variables = [*self.shared, *self.added]
        own = [(inside(v, v.centre), v.spread / (v.scale if v.positive else 1.0)) for v in variables]
        difference = [(0.0, difference_spread(self.shared[n])) for n in self.differs]
        count = len(self.shared)
        every = np.array([*own[:count], *difference, *own[count:]]).reshape(-1, 2)
        return every[:, 0], every[:, 1]

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Least and largest numbers, inside."""
        own = [(inside(v, v.lower), inside(v, v.upper)) for v in [*self.shared, *self.added]]
        reach = [
            np.log(_LARGEST_FACTOR) if v.positive else v.upper - v.lower
            for v in (self.shared[n] for n in self.differs)
        ]
        count = len(self.shared)
        every = np.array([*own[:count], *[(-each, each) for each in reach], *own[count:]]).reshape(-1, 2)
        return every[:, 0], every[:, 1]

    def values(self, x: FloatArray, *, after: bool) -> tuple[FloatArray, BoolArray]:
        """Value vectors and active effects of one side.

        Args:
            x: numbers of this model, shape (sets, size).
            after: whether of the side after.

        Returns:
            Arrays of shape (sets, parameters) and (sets, effects).
        """
        vector, active = (self.after if after else self.plant).vectors()
        found = np.repeat(vector[None], len(x), axis=0)
        index, count = self.plant.layout.index, len(self.shared)
        numbers = x[:, :count].copy()
        if after:
            numbers[:, list(self.differs)] += x[:, count : count + len(self.differs)]
            numbers = np.hstack([numbers, x[:, count + len(self.differs) :]])
        for n, variable in enumerate([*self.shared, *(self.added if after else ())]):
            value = outside(variable, numbers[:, n])
            for slot, ratio in zip(variable.slots, variable.ratios, strict=True):
                found[:, index[slot]] = value * ratio
        return found, np.repeat(active[None], len(x), axis=0)

    def plant_at(self, x: FloatArray, *, after: bool) -> Plant:
        """The plant of one side."""
        base = self.after if after else self.plant
        values, _ = self.values(x[None], after=after)
        index = base.layout.index
        return base.with_values({slot: float(values[0, index[slot]]) for slot in base.values})


def inside(variable: Variable, value: float) -> float:
    """A value as a fit moves it: the logarithm of what can only be positive."""
    if not variable.positive:
        return value
    return float(np.log(max(value, variable.lower, _LEAST_SHARE * variable.scale)))


def outside(variable: Variable, number: FloatArray) -> FloatArray:
    """The SI value, within its bounds."""
    value = np.exp(number) if variable.positive else number
    return np.asarray(np.clip(value, variable.lower, variable.upper))


def difference_spread(variable: Variable) -> float:
    """How far a variable may well differ between the sides, inside: one standard deviation."""
    if not variable.positive:
        return variable.scale if np.isinf(variable.spread) else max(variable.scale, variable.spread)
    return _MOTOR_SPREAD if is_motor_constant(variable.slots[0]) else _SPREAD


def all_shared(plant: Plant, scale: Scale) -> Model:
    """One plant on both sides."""
    return Model(plant, variables_of(plant, plant, scale), (), (), plant, ())
