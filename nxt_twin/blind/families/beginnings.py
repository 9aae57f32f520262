"""How recordings begin: with the motor off, in the midst of a program, or cut out of a motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, final

from numpy.random import Generator

BeginningName = Literal["off", "driven", "cut"]

CHANCES: Final[dict[BeginningName, float]] = {"off": 0.5, "driven": 0.25, "cut": 0.25}
NEXT_COMMAND_S: Final = (0.3, 3.0)
BEFORE_S: Final = (0.5, 3.0)


@final
@dataclass(frozen=True)
class Beginning:
    """How one recording begins.

    Attributes:
        name: of the kind.
        ahead_s: how far the program is when the motor first gets a command, s.
        before_s: how long the motor moves before the first row, s.
    """

    name: BeginningName
    ahead_s: float
    before_s: float


def draw_kind(rng: Generator) -> BeginningName:
    """The kind of a case: a host begins all of its recordings alike."""
    names = list(CHANCES)
    return names[int(rng.choice(len(names), p=list(CHANCES.values())))]


def draw_beginning(rng: Generator, name: BeginningName) -> Beginning:
    """One recording's beginning; all kinds take as many numbers from `rng`."""
    ahead_s, before_s = float(rng.uniform(*NEXT_COMMAND_S)), float(rng.uniform(*BEFORE_S))
    return Beginning(name, 0.0 if name == "off" else ahead_s, before_s if name == "cut" else 0.0)
