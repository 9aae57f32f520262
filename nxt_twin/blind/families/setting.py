"""The inputs and outputs of the sampler of a hidden effect."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final, final

import numpy as np
from numpy.random import Generator

from nxt_twin.blind.families.numbers import Numbers
from nxt_twin.blind.kinds import Equation, Size

LowHigh = tuple[float, float]

STALL_NM: Final = 0.52


@final
@dataclass(frozen=True)
class DrawnCase:
    """One case as far as it is drawn.

    Attributes:
        rng: the case's source of chance.
        size: which range a size is drawn from.
        motor: as it is so far.
        recordings: how many there are.
        duration_s: how long each is.
        poll_s: the usual time between two polls.
        starts_deg: hub angle at each start.
        reach_deg: lowest and highest angle of each recording without the effect.
    """

    rng: Generator
    size: Size
    motor: Numbers
    recordings: int
    duration_s: float
    poll_s: float
    starts_deg: tuple[float, ...]
    reach_deg: tuple[LowHigh, ...]

    def among(self, **ranges: LowHigh) -> float:
        """Drawn by ratio from the range of this size: `small`, `medium` or `large`."""
        return self.between(*ranges[self.size])

    def between(self, low: float, high: float) -> float:
        """Drawn by ratio between two positive bounds."""
        return float(low * (high / low) ** float(self.rng.random()))

    def torque(self, **ranges: LowHigh) -> float:
        """As `among`, in N·m of a motor with the NXT's stall torque, scaled to this one's."""
        return self.among(**ranges) * self.motor.stall_nm / STALL_NM

    def inertia(self, **ranges: LowHigh) -> float:
        """As `among`, in shares of this motor's inertia."""
        return self.among(**ranges) * self.motor.inertia_kg_m2

    def side(self) -> float:
        """+1 or -1."""
        return 1.0 if self.rng.random() < 0.5 else -1.0

    def phase(self) -> float:
        """An angle in the turn, rad."""
        return float(self.rng.random() * 2.0 * np.pi - np.pi)

    def pick(self, *choices: float) -> float:
        """One of these."""
        return float(choices[int(self.rng.integers(len(choices)))])


@final
@dataclass(frozen=True)
class HiddenEffect:
    """One effect with its numbers drawn.

    Attributes:
        params: the truth, under the contract's names, the main one first.
        numbers: what changes in the motor.
        chain: what changes between motor and rows.
        absent: what makes the same motor without the effect, where it is not the motor before.
        by_recording: further changes, one mapping a recording; empty where all are alike.
    """

    params: Mapping[str, float]
    numbers: Mapping[str, float] = field(default_factory=dict)
    chain: Mapping[str, float] = field(default_factory=dict)
    absent: Mapping[str, float] = field(default_factory=dict)
    by_recording: tuple[Mapping[str, float], ...] = ()


@final
@dataclass(frozen=True)
class Hideable:
    """An effect that a family can hide.

    Attributes:
        id: the contract's, or that of a physics in nobody's library.
        equation: what changes.
        draw: draws its numbers.
        known: whether the contract names it.
        leaves_out: the baseline's key that is left out.
        clashes: ids that do not stand in the same case.
        coasts: whether it shows only where the motor coasts.
        least_recordings: how many recordings it needs.
    """

    id: str
    equation: Equation
    draw: Callable[[DrawnCase], HiddenEffect]
    known: bool = True
    leaves_out: str | None = None
    clashes: tuple[str, ...] = ()
    coasts: bool = False
    least_recordings: int = 1
