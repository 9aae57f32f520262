"""An effect of a sensor is one declaration, as one of a plant is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import final


@final
@dataclass(frozen=True)
class SensorParameter:
    """One parameter of an effect.

    Attributes:
        name: in JSON and sensor files (docs/sensors.md).
        field: of the sensor's parameters dataclass.
        unit: of both.
        lower, upper: bounds.
        scale: a change that matters; the unit in which the fit moves.
        default: what it is while the effect is off.
    """

    name: str
    field: str
    unit: str
    lower: float
    upper: float
    scale: float
    default: float | None


@final
@dataclass(frozen=True)
class SensorEffect:
    """Something that a sensor may do beyond its ideal.

    Attributes:
        id: its name in sensor files and JSON (docs/sensors.md).
        name: in words.
        equation: the law in plain text, with its source.
        shows: the regimes in which it shows.
        parameters: what is fitted; the first is the main one.
        confusable_with: ids of effects that look alike, with what tells them apart.
        replaces: fields of the ideal sensor that mean nothing once the effect is in.
        laws: fields that choose between laws which the readings hardly tell apart; estimates are averaged over them.
        stepped: its likelihood goes in steps from target to target. Its estimates then come from a random walk over
            the likely values, and not from the curvature at the maximum.
        prior_nats: what it has to earn beyond its parameters' share, for the places in which it was looked for.
    """

    id: str
    name: str
    equation: str
    shows: tuple[str, ...]
    parameters: tuple[SensorParameter, ...]
    confusable_with: Mapping[str, str] = field(default_factory=dict)
    replaces: tuple[str, ...] = ()
    laws: tuple[Mapping[str, float], ...] = ()
    stepped: bool = False
    prior_nats: float = 0.0
