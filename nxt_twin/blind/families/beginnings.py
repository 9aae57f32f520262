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
        ahead_s: how far the program is when the motor first gets a command, s.
        before_s: how long the motor moves before the first row, s.
    """

    ahead_s: float
    before_s: float


def draw_kind(rng: Generator) -> BeginningName:
    """The kind of a case: a host begins all of its recordings alike."""
    names = list(CHANCES)
    return names[int(rng.choice(len(names), p=list(CHANCES.values())))]


def draw_beginning(rng: Generator, name: BeginningName) -> Beginning:
    """One recording's beginning."""
    ahead_s = 0.0 if name == "off" else float(rng.uniform(*NEXT_COMMAND_S))
    return Beginning(ahead_s, float(rng.uniform(*BEFORE_S)) if name == "cut" else 0.0)
