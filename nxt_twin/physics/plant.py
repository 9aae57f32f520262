"""A plant: a base model, the effects in it, and the values of their parameters."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.errors import PlantError
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import BASE_OWNER, BASES, DRIVEN_BY, Layout, Slot, layout
from nxt_twin.physics.parameter import Frame, Parameter
from nxt_twin.recording.recording import GOALS, InputKind

_FRAME_OF_INPUT: dict[InputKind, Frame] = {
    "power_pct": "motor",
    "voltage_v": "motor",
    "current_a": "motor",
    "torque_nm": "rotary",
    "force_n": "linear",
    "goal_position_deg": "motor",
    "goal_position_rad": "motor",
}
_INPUT_OF_FRAME: dict[Frame, InputKind] = {"motor": "power_pct", "rotary": "torque_nm", "linear": "force_n"}


_NEVER_ZERO: Final = frozenset(("inertia", "resistance", "torque_constant", "back_emf"))
"""What equations of motion divide by: a motor without it is none."""


@final
@dataclass(frozen=True, repr=False)
class Plant:
    """A model of one axis.

    Attributes:
        layout: the base model and the frame it stands in.
        active: ids of the effects in it.
        values: SI values of the base's parameters and of the active effects'.
    """

    layout: Layout
    active: frozenset[str]
    values: Mapping[Slot, float]

    def __repr__(self) -> str:
        """Short: the kind and the effects."""
        effects = ", ".join(effect.id for effect in self.effects)
        return f"<Plant {self.layout.base.kind}: {effects or 'no effects'}>"

    @property
    def effects(self) -> tuple[Effect, ...]:
        """The effects in the plant, in the order in which they act."""
        return tuple(effect for effect in self.layout.effects if effect.id in self.active)

    def vectors(self) -> tuple[FloatArray, BoolArray]:
        """The value vector (inactive parameters at their first start) and the mask of active effects."""
        values = self.layout.first_starts.copy()
        index = self.layout.index
        for slot, value in self.values.items():
            if slot in index:
                values[index[slot]] = value
        mask = [effect.id in self.active for effect in self.layout.effects]
        return values, np.array(mask)

    def with_values(self, values: Mapping[Slot, float]) -> Plant:
        """The same plant with some SI values replaced."""
        return replace(self, values={**self.values, **values})

    def with_effect(self, effect_id: str, values: Mapping[str, float]) -> Plant:
        """The plant with one more effect, its SI values given by symbol; what it supersedes goes.

        Parameters that a plant file may leave out may be left out here.
        """
        effect = self.layout.effect(effect_id)
        bare = self.without(effect.supersedes)
        left_out = {p.symbol: p.otherwise * p.si for p in effect.parameters if p.otherwise is not None}
        added = {Slot(effect_id, symbol): value for symbol, value in {**left_out, **values}.items()}
        return Plant(self.layout, bare.active | {effect_id}, {**bare.values, **added})

    def adding(self, effect_id: str, **parameters: float) -> Plant:
        """The plant with one more effect.

        Args:
            effect_id: such as `backlash` (docs/effects.md).
            parameters: under the names and in the units of a plant file.

        Raises:
            PlantError: there is no such effect for this kind of plant, or a parameter is wrong or missing.

        >>> import nxt_twin as nt
        >>> nt.load_plant("nxt_motor").adding("constant_load", load_torque_nm=0.02)
        <Plant dc_motor: coulomb_friction, viscous_friction, inductance, constant_load>
        """
        config = self.to_config()
        if self.layout.effect(effect_id).plain:
            config |= parameters
        else:
            config["effects"] = {**config.get("effects", {}), effect_id: parameters}
        return plant_from_config(config, _INPUT_OF_FRAME[self.layout.frame])

    def without(self, effect_ids: Iterable[str]) -> Plant:
        """The plant without these effects."""
        gone = set(effect_ids)
        kept = {slot: value for slot, value in self.values.items() if slot.owner not in gone}
        return Plant(self.layout, self.active - gone, kept)

    def to_config(self) -> dict[str, Any]:
        """The plant as a YAML-ready mapping (docs/formats.md#plant-files), which `plant_from_config` reads back."""
        config: dict[str, Any] = {"kind": self.layout.base.kind}
        nested: dict[str, dict[str, float]] = {}
        plain = {effect.id for effect in self.effects if effect.plain} | {BASE_OWNER}
        for slot, parameter in self.layout.parameters.items():
            if slot not in self.values or parameter.is_idle(self.values[slot]):
                continue
            target = config if slot.owner in plain else nested.setdefault(slot.owner, {})
            target[parameter.name] = float(f"{self.values[slot] / parameter.si:.8g}")
        if nested:
            config["effects"] = nested
        return config


_LOOP = (
    "a goal drives a servo: write `kind: servo` and `position_gain_pct_per_deg: …` in the plant, or another "
    "`input: {kind: …}` in the mapping"
)


def frame_for(kind: str, input_kind: InputKind) -> Frame:
    """The frame of a plant of `kind` that is driven by `input_kind`.

    Raises:
        PlantError: this kind of plant cannot be driven so, or there is no such kind.
    """
    frame = layout(kind, _FRAME_OF_INPUT[input_kind]).frame
    if (BASES[kind].control is not None) != (input_kind in GOALS):
        mend = _LOOP if input_kind in GOALS else DRIVEN_BY
        raise PlantError(f"a {kind} is not driven by {input_kind}", where="plant", mend=mend)
    return frame


def plant_from_config(config: Mapping[str, Any], input_kind: InputKind) -> Plant:
    """Read a plant (docs/formats.md#plant-files) that is driven by `input_kind`.

    A key of a plain effect that is left out is physics left out; one that a nested effect supersedes is dropped.

    Raises:
        PlantError: a kind, key, value or effect that is none, or a required key that is missing.
    """
    kind = config.get("kind")
    if not isinstance(kind, str):
        raise PlantError("no kind", where="plant", mend=f"add 'kind:', one of {', '.join(BASES)}")
    plan = layout(kind, frame_for(kind, input_kind))
    nested = config.get("effects") or {}
    if not isinstance(nested, Mapping):
        raise PlantError("is no mapping of effect ids", where="plant, effects")
    plain = tuple(effect for effect in plan.effects if effect.plain)
    keys = {BASE_OWNER: plan.base.parameters, **{effect.id: effect.parameters for effect in plain}}
    _refuse_unknown(
        set(config) - {"kind", "effects"},
        [p.in_frame(plan.frame).name for ps in keys.values() for p in ps],
        where="plant",
    )
    values = _read_owner(plan, BASE_OWNER, config, "plant")
    active = set()
    for effect in plain:
        names = [p.in_frame(plan.frame).name for p in effect.parameters]
        if any(name in config for name in names):
            active.add(effect.id)
            values |= _read_owner(plan, effect.id, config, "plant")
    for effect_id, given in nested.items():
        effect = plan.effect(str(effect_id))
        where = f"plant, effects, {effect_id}"
        if effect.plain or not isinstance(given, Mapping):
            raise PlantError("is not a mapping of parameters of a nested effect", where=where)
        _refuse_unknown(set(given), [p.in_frame(plan.frame).name for p in effect.parameters], where=where)
        active -= set(effect.supersedes)
        values = {slot: value for slot, value in values.items() if slot.owner not in effect.supersedes}
        active.add(effect.id)
        values |= _read_owner(plan, effect.id, given, where)
    return Plant(plan, frozenset(active), values)


def _read_owner(plan: Layout, owner: str, given: Mapping[str, Any], where: str) -> dict[Slot, float]:
    found = {}
    for slot, parameter in plan.parameters.items():
        if slot.owner != owner:
            continue
        value = given.get(parameter.name, parameter.otherwise)
        found[slot] = _number(value, parameter, where) * parameter.si
    return found


def _number(value: object, parameter: Parameter, where: str) -> float:
    place = f"{where}, {parameter.name}"
    if value is None:
        raise PlantError("is missing", where=place, mend=f"give it in {parameter.unit}")
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise PlantError(f"'{value}' is no finite number", where=place, mend=f"give it in {parameter.unit}")
    if parameter.lower >= 0.0 and value < 0.0:
        raise PlantError(f"{value} is negative", where=place, mend=f"give it in {parameter.unit}")
    if parameter.symbol in _NEVER_ZERO and value == 0.0:
        raise PlantError("is zero", where=place, mend=f"give its size in {parameter.unit}")
    return float(value)


def _refuse_unknown(given: set[Any], known: list[str], *, where: str) -> None:
    for key in sorted(map(str, given - set(known))):
        near = difflib.get_close_matches(key, known, n=1)
        mend = f"did you mean '{near[0]}'?" if near else f"known are {', '.join(known)}"
        raise PlantError(f"unknown key '{key}'", where=where, mend=mend)
