"""One plant on both sides but for what differs: a shared vector, differences after, and effects after."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.fitting.fit import Variable
from nxt_twin.diagnose.fitting.variables import variables_of
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.parameter import Scale
from nxt_twin.physics.plant import Plant

_LEAST_SHARE = 1e-3  # of its scale: the least value of a positive variable
_LARGEST_FACTOR = 30.0  # by which a positive parameter may differ after, either way
_MOTOR = frozenset({"resistance", "torque_constant"})
_MOTOR_SPREAD = 0.2  # of the logarithm: a motor's constants hardly change while somebody works at the load
_SPREAD = 1.0  # of the logarithm: one standard deviation by which any other positive parameter differs
_WEIGHED = frozenset({"gravity", "inertia"})
_WEIGHED_SPREAD = 0.25  # of the logarithm, before: a load can be weighed, and it moved as its model predicts
_SUPPLY_SPREAD = 0.3  # of the logarithm: one standard deviation by which an unread supply differs
_SUPPLY_REACH = float(np.log(3.0))
_SUPPLY = Slot(BASE_OWNER, "supply_v")


@final
@dataclass(frozen=True)
class WayToDiffer:
    """One way in which the plant may differ after, moved by one number inside.

    An unread supply is such a way. Motion under s times the voltage equals motion with 1/s times the torque
    constant and 1/s² times the resistance.

    Attributes:
        slot: the parameter that differs.
        weights: by how much the number moves each of the shared variables, by index.
        spread: how far it may well differ, inside: one standard deviation.
        reach: how far it may differ at most, inside.
        size: an ordinary difference, inside.
    """

    slot: Slot
    weights: tuple[tuple[int, float], ...]
    spread: float
    reach: float
    size: float

    @property
    def is_motor_constant(self) -> bool:
        """Whether it belongs to the motor itself rather than to what it moves."""
        return self.slot.symbol in _MOTOR

    def of(self, slopes: FloatArray) -> FloatArray:
        """The slope for its number, from those for the shared variables, shape (readings,)."""
        return np.asarray(sum(weight * slopes[index] for index, weight in self.weights))


@final
@dataclass(frozen=True)
class Model:
    """Parameters that both sides share, and those that differ.

    Attributes:
        plant: as it came; the parameters that no fit moves are taken from it.
        shared: variables of both sides.
        ways: in which the side after may differ: first one for each of `shared`.
        differs: indices into `ways` of those in which it does.
        effects: ids of effects that act after and not before.
        after: `plant` with these effects, at their starts.
        added: variables of these effects.
        stand_ins: parameters that cannot differ: all but the main one of an effect that the plant lacked.
    """

    plant: Plant
    shared: tuple[Variable, ...]
    ways: tuple[WayToDiffer, ...]
    differs: tuple[int, ...]
    effects: tuple[str, ...]
    after: Plant
    added: tuple[Variable, ...]
    stand_ins: frozenset[Slot] = frozenset()

    @property
    def size(self) -> int:
        """How many numbers a fit of it moves."""
        return len(self.shared) + len(self.differs) + len(self.added)

    @property
    def changes(self) -> int:
        """How many parameters and effects differ."""
        return len(self.differs) + len(self.effects)

    @property
    def may_differ(self) -> tuple[int, ...]:
        """Indices of the ways in which the side after may differ and does not yet."""
        ways = enumerate(self.ways)
        return tuple(n for n, way in ways if n not in self.differs and way.slot not in self.stand_ins)

    @property
    def remembers(self) -> bool:
        """Whether an effect on the side after has states of its own."""
        return any(effect.states for effect in self.after.effects)

    @property
    def moves_inertia(self) -> bool:
        """Whether the inertia differs."""
        return any(self.ways[n].slot.symbol == "inertia" for n in self.differs)

    @property
    def motor_constants(self) -> int:
        """How many of the motor's own constants differ."""
        return sum(self.ways[n].is_motor_constant for n in self.differs)

    def differing(self, indices: Sequence[int]) -> Model:
        """With more ways in which the side after differs, in the order of `ways`."""
        return replace(self, differs=tuple(sorted({*self.differs, *indices})))

    def alike(self, index: int) -> Model:
        """With one way less."""
        return replace(self, differs=tuple(n for n in self.differs if n != index))

    def with_effect(self, effect_id: str, values: dict[str, float], scale: Scale) -> Model:
        """With one more effect after, from these starting values (SI, by symbol)."""
        return self._effects(self.after.with_effect(effect_id, values), (*self.effects, effect_id), scale)

    def lacking(self, effect_id: str, values: dict[str, float], scale: Scale) -> Model:
        """With one more effect on both sides, and none after alone."""
        plant = self.plant.with_effect(effect_id, values)
        kept = {self.ways[n].slot for n in self.differs}
        unread = any(way.slot == _SUPPLY for way in self.ways)
        bare = _shared(plant, variables_of(plant, self.plant, scale), supply_unread=unread)
        bare = bare.differing([n for n, way in enumerate(bare.ways) if way.slot in kept])
        for each in self.effects:
            own = {slot.symbol: v for slot, v in self.after.values.items() if slot.owner == each}
            bare = bare.with_effect(each, own, scale)
        minor = {Slot(effect_id, each.symbol) for each in plant.layout.effect(effect_id).parameters[1:]}
        return replace(bare, stand_ins=self.stand_ins | minor)

    def without_effect(self, effect_id: str, scale: Scale) -> Model:
        """With an effect less after; what it superseded comes back."""
        after = self.plant
        kept = tuple(each for each in self.effects if each != effect_id)
        for each in kept:
            own = {slot.symbol: v for slot, v in self.after.values.items() if slot.owner == each}
            after = after.with_effect(each, own)
        return self._effects(after, kept, scale)

    def _effects(self, after: Plant, effects: tuple[str, ...], scale: Scale) -> Model:
        added = variables_of(after, self.plant, scale, effects)
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
            *(("differs", self.ways[n].slot) for n in self.differs),
            *(("added", variable.slots[0]) for variable in self.added),
        ]

    def priors(self) -> tuple[FloatArray, FloatArray]:
        """Means and standard deviations, inside."""
        variables = [*self.shared, *self.added]
        own = [(inside(v, v.centre), _spread_before(v)) for v in variables]
        difference = [(0.0, self.ways[n].spread) for n in self.differs]
        count = len(self.shared)
        every = np.array([*own[:count], *difference, *own[count:]]).reshape(-1, 2)
        return every[:, 0], every[:, 1]

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Least and largest numbers, inside."""
        own = [(inside(v, v.lower), inside(v, v.upper)) for v in [*self.shared, *self.added]]
        reach = [self.ways[n].reach for n in self.differs]
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
            for place, n in enumerate(self.differs, start=count):
                for index_of, weight in self.ways[n].weights:
                    numbers[:, index_of] += weight * x[:, place]
            numbers = np.hstack([numbers, x[:, count + len(self.differs) :]])
        for n, variable in enumerate([*self.shared, *(self.added if after else ())]):
            value = outside(variable, numbers[:, n])
            for slot, ratio in zip(variable.slots, variable.ratios, strict=True):
                found[:, index[slot]] = value * ratio
        return found, np.repeat(active[None], len(x), axis=0)

    def plant_as_told(self, x: FloatArray, *, after: bool) -> Plant:
        """The plant of one side, with a supply that differs in its own place."""
        unread = [n for n in self.differs if self.ways[n].slot == _SUPPLY]
        if not after or not unread:
            return self.plant_at(x, after=after)
        place = len(self.shared) + self.differs.index(unread[0])
        plant = self.plant_at(np.where(np.arange(x.size) == place, 0.0, x), after=True)
        return plant.with_values({_SUPPLY: self.plant.values[_SUPPLY] * float(np.exp(x[place]))})

    def plant_at(self, x: FloatArray, *, after: bool) -> Plant:
        """The plant of one side, as it moves under the supply of the side before."""
        base = self.after if after else self.plant
        values, _ = self.values(x[None], after=after)
        index = base.layout.index
        return base.with_values({slot: float(values[0, index[slot]]) for slot in base.values})


def inside(variable: Variable, value: float) -> float:
    """A value as a fit moves it: the logarithm of what can only be positive."""
    if not variable.positive:
        return value
    return float(np.log(max(value, variable.lower, _LEAST_SHARE * variable.scale)))


def _spread_before(variable: Variable) -> float:
    """One standard deviation of the prior, inside."""
    spread = variable.spread / (variable.scale if variable.positive else 1.0)
    weighed = variable.positive and variable.slots[0].symbol in _WEIGHED
    return min(spread, _WEIGHED_SPREAD) if weighed else spread


def outside(variable: Variable, number: FloatArray) -> FloatArray:
    """The SI value, within its bounds."""
    value = np.exp(number) if variable.positive else number
    return np.asarray(np.clip(value, variable.lower, variable.upper))


def all_shared(plant: Plant, scale: Scale, *, supply_unread: bool = False) -> Model:
    """One plant on both sides; with `supply_unread` the supply may be another after, and no recording shows it."""
    return _shared(plant, variables_of(plant, plant, scale), supply_unread=supply_unread)


def _shared(plant: Plant, variables: tuple[Variable, ...], *, supply_unread: bool) -> Model:
    ways = [_own_way(n, variable) for n, variable in enumerate(variables)]
    index = {variable.slots[0].symbol: n for n, variable in enumerate(variables)}
    if supply_unread and _SUPPLY in plant.values and index.keys() >= _MOTOR:
        weights = ((index["torque_constant"], -1.0), (index["resistance"], -2.0))
        ways.append(WayToDiffer(_SUPPLY, weights, _SUPPLY_SPREAD, _SUPPLY_REACH, 1.0))
    return Model(plant, variables, tuple(ways), (), (), plant, ())


def _own_way(n: int, variable: Variable) -> WayToDiffer:
    slot, weights = variable.slots[0], ((n, 1.0),)
    if variable.positive:
        spread = _MOTOR_SPREAD if slot.symbol in _MOTOR else _SPREAD
        return WayToDiffer(slot, weights, spread, float(np.log(_LARGEST_FACTOR)), 1.0)
    spread = variable.scale if np.isinf(variable.spread) else max(variable.scale, variable.spread)
    return WayToDiffer(slot, weights, spread, variable.upper - variable.lower, max(variable.scale, 1e-12))
