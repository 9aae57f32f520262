"""The declaration of an effect that a case can conceal."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import final

import numpy as np
from numpy.random import Generator

from nxt_twin.blind.kinds import Equation, Size
from nxt_twin.blind.truth.motor import Motor

LowHigh = tuple[float, float]


@final
@dataclass(frozen=True)
class Draw:
    """One effect with its numbers drawn.

    Attributes:
        params: the true values, under the names of docs/effects.md (an unknown effect's under its own); the
            main one first.
        motor: fields of `Motor` that the effect changes.
        sensing: fields of `Sensing` that it changes.
        absent: fields of `Motor` that make the same motor without the effect, where that is not simply the
            motor before the change.
        by_recording: further changes of `Motor`, one mapping a recording; empty where all are alike.
    """

    params: Mapping[str, float]
    motor: Mapping[str, float] = field(default_factory=dict)
    sensing: Mapping[str, float] = field(default_factory=dict)
    absent: Mapping[str, float] = field(default_factory=dict)
    by_recording: tuple[Mapping[str, float], ...] = ()


@final
@dataclass(frozen=True)
class Situation:
    """The inputs of a sampler.

    Attributes:
        rng: the case's own source of chance.
        size: which of the three ranges to draw from.
        motor: the motor as it is so far.
        recordings: how many recordings the case has.
        duration_s: how long each is.
        starts_deg: hub angle at each recording's start.
        reach_deg: lowest and highest hub angle of each recording without the effect; empty unless the effect
            says `needs_reach`.
    """

    rng: Generator
    size: Size
    motor: Motor
    recordings: int
    duration_s: float
    starts_deg: tuple[float, ...]
    reach_deg: tuple[LowHigh, ...] = ()

    def sized(self, small: LowHigh, medium: LowHigh, large: LowHigh) -> float:
        """A log-uniform draw from the range of this size."""
        low, high = {"small": small, "medium": medium, "large": large}[self.size]
        return self.between(low, high)

    def between(self, low: float, high: float) -> float:
        """A log-uniform draw, whatever the size; both bounds positive."""
        return float(np.exp(self.rng.uniform(np.log(low), np.log(high))))

    def sign(self) -> float:
        """+1 or -1."""
        return float(self.rng.choice((-1.0, 1.0)))

    def one_of(self, *choices: float) -> float:
        """One of the choices."""
        return float(self.rng.choice(choices))

    def angle_rad(self) -> float:
        """An angle anywhere in the turn, -π…π."""
        return float(self.rng.uniform(-np.pi, np.pi))


@final
@dataclass(frozen=True)
class ConcealedEffect:
    """An effect that a case can hide.

    Attributes:
        id: the id in docs/effects.md, or an unknown effect's own.
        equation: the one that changes: the hub's torque, what makes the current, what joins two bodies, what the
            encoder makes of the angle, or the stamps.
        sample: draws its numbers.
        known: whether docs/effects.md names it.
        leaves_out: the key that the baseline lacks, for the plain terms.
        clashes: ids that cannot stand in the same case, since both set the same term.
        needs_coasting: whether only a coasting motor shows it.
        needs_reach: whether its numbers depend on where the motor goes without it.
    """

    id: str
    equation: Equation
    sample: Callable[[Situation], Draw]
    known: bool = True
    leaves_out: str | None = None
    clashes: tuple[str, ...] = ()
    needs_coasting: bool = False
    needs_reach: bool = False
