"""A sensor's parameters as the keys of a YAML file, and back.

Base parameters stand at the top; those of an effect under `effects:` and the effect's id, by the names of
docs/effects.md. A parameter that is left out has its default, an effect that is left out is off.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Self, TypeVar, final

from nxt_twin.sensors.errors import SensorError

ParametersT = TypeVar("ParametersT")

EffectFields = Mapping[str, Mapping[str, str]]
"""For each effect's id, its parameters' names in files and the dataclass fields that hold them."""


@final
@dataclass(frozen=True)
class SensorLayout:
    """How a sensor's parameters stand in a file.

    Attributes:
        kind: the value of the key `kind`.
        effects: the effects that the sensor may have, and their parameters.
    """

    kind: str
    effects: EffectFields

    @property
    def nested_fields(self) -> frozenset[str]:
        """The dataclass fields that belong to an effect."""
        return frozenset(field for names in self.effects.values() for field in names.values())


class Configured:
    """The base of the dataclasses of sensors' parameters; each names its layout."""

    layout: ClassVar[SensorLayout]

    def to_config(self) -> dict[str, Any]:
        """The parameters as a YAML-ready mapping."""
        return to_config(self.layout, self)

    @classmethod
    def from_config(cls, config: Mapping[str, Any]) -> Self:
        """Read them from a mapping as `to_config` writes it.

        Raises:
            SensorError: a kind, key or value that is none.
        """
        return from_config(cls.layout, cls, config)


def to_config(layout: SensorLayout, parameters: Any) -> dict[str, Any]:  # noqa: ANN401  # any parameters dataclass
    """A YAML-ready mapping; effects that are at their defaults, that is off, are left out."""
    nested = layout.nested_fields
    config: dict[str, Any] = {"kind": layout.kind}
    defaults = {field.name: field.default for field in fields(parameters)}
    for name in defaults:
        value = getattr(parameters, name)
        if name not in nested and value is not None:
            config[name] = _short(value)
    effects = {}
    for effect, names in layout.effects.items():
        values = {name: getattr(parameters, field) for name, field in names.items()}
        if any(values[name] != defaults[field] for name, field in names.items()):
            effects[effect] = {name: _short(value) for name, value in values.items() if value is not None}
    return config | ({"effects": effects} if effects else {})


def from_config(
    layout: SensorLayout, parameters_class: type[ParametersT], config: Mapping[str, Any]
) -> ParametersT:
    """Read parameters from a mapping as `to_config` writes it.

    Raises:
        SensorError: the kind is another, or a key or value is none.
    """
    if config.get("kind") != layout.kind:
        raise SensorError(f"is no {layout.kind}", where="sensor", mend=f"write kind: {layout.kind}")
    nested = layout.nested_fields
    plain = [field.name for field in fields(parameters_class) if field.name not in nested]  # type: ignore[arg-type]
    given = {key: value for key, value in config.items() if key not in ("kind", "effects")}
    _refuse_unknown(given, plain, "sensor")
    values = {name: _number(value, f"sensor, {name}") for name, value in given.items()}
    effects = config.get("effects") or {}
    if not isinstance(effects, Mapping):
        raise SensorError("is no mapping of effect ids", where="sensor, effects")
    _refuse_unknown(effects, layout.effects, "sensor, effects")
    for effect, own in effects.items():
        where = f"sensor, effects, {effect}"
        if not isinstance(own, Mapping):
            raise SensorError("is no mapping of parameters", where=where)
        names = layout.effects[effect]
        _refuse_unknown(own, names, where)
        values |= {names[name]: _number(value, f"{where}, {name}") for name, value in own.items()}
    return parameters_class(**values)


def _refuse_unknown(given: Iterable[Any], known: Iterable[str], where: str) -> None:
    names = list(known)
    for key in given:
        if key not in names:
            near = difflib.get_close_matches(str(key), names, n=1)
            mend = f"did you mean '{near[0]}'?" if near else f"known are {', '.join(names)}"
            raise SensorError(f"unknown key '{key}'", where=where, mend=mend)


def _number(value: object, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise SensorError(f"'{value}' is no finite number", where=where, mend="write a number")
    return float(value)


def _short(value: float) -> float:
    return float(f"{value:.8g}")
