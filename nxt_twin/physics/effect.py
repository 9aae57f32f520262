"""An effect is one declaration; library, kernel, diagnosis, report and docs all read it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, final

from nxt_twin.physics.parameter import FRAMES, Frame, Parameter
from nxt_twin.recording.recording import GOALS, InputKind

if TYPE_CHECKING:
    from nxt_twin.physics.signals import Signals

Equation = Literal["torque_balance", "electrical", "kinematic", "measurement", "timing"]
Regime = Literal[
    "low_speed",
    "reversal",
    "high_speed",
    "high_current",
    "direction",
    "angle",
    "elapsed_time",
    "after_command",
    "after_gap",
]

Stage = Literal[
    "delay",
    "pace",
    "lag",
    "commanded",
    "goal",
    "duty",
    "supply",
    "inertia",
    "resistance",
    "inductance",
    "drop",
    "knee",
    "limit",
    "torque",
    "damping",
    "friction",
    "lean",
    "borne",
    "hold",
    "creep",
    "advance",
    "stop",
    "reading",
    "scatter",
    "outlier",
]
"""Where in a step a term acts; `stages.STAGES` says how its value is used."""

Term = Callable[..., float | tuple[float, ...]]
"""A plain function of scalars. It asks for what it needs by the names of its arguments: quantities of the step
(`stages.STAGES`), symbols of its effect's parameters (SI), and names of its effect's states."""


@final
@dataclass(frozen=True, repr=False)
class Effect:
    """A piece of physics that a model may have or lack.

    Attributes:
        id: its name in plant files and JSON (docs/effects.md).
        name: the field's standard name.
        equation: the law in plain text.
        equation_of: which equation of the plant it stands in.
        shows: regimes in which it shows.
        source: where the law is from.
        confusable_with: ids of effects that look alike, with the input that tells them apart. One side declares
            it; the library gives it to both.
        parameters: what is fitted. The first is the main one.
        terms: the law as functions, by stage.
        states: names of the extra states, zero where a run starts anew and nobody knows them.
        moving: those of them that are speeds and start with the plant's own.
        placed: those of them that are angles and start with the plant's own.
        lasting: those of them that such a start leaves as they are.
        frames: frames of plants that can have it.
        kinds: kinds of plants that can have it; empty is all.
        supersedes: ids of effects whose parameters this one replaces while it is in the plant.
        inputs: kinds of input with which it makes sense; empty is all.
        plain: its parameters are keys of the plant itself rather than of an entry under `effects:`.
        fault: a fault of the recording rather than physics of the plant.
        counted: it makes sense only where readings are counts of whole steps.
        neutral: value of the main parameter, in its unit, at which the effect does nothing.
        notable: size of the main parameter, in its unit at NXT scale, from which the effect has a name. Motors of one
            make differ by smaller sizes. Of two parameters that replace one, half their difference; of one that has
            to exceed another, the excess.
        notable_most: the size above which the effect has no name, where a larger parameter does less.
        commoner_nats: log odds of meeting it rather than another effect, before any reading tells.
        further_starts: SI values by symbol that recordings suggest together, beside every combination of starts.
    """

    id: str
    name: str
    equation: str
    equation_of: Equation
    shows: tuple[Regime, ...]
    parameters: tuple[Parameter, ...]
    terms: Mapping[Stage, Term]
    confusable_with: Mapping[str, str] = field(default_factory=dict)
    source: str = ""
    states: tuple[str, ...] = ()
    moving: tuple[str, ...] = ()
    placed: tuple[str, ...] = ()
    lasting: tuple[str, ...] = ()
    frames: tuple[Frame, ...] = FRAMES
    kinds: tuple[str, ...] = ()
    supersedes: tuple[str, ...] = ()
    inputs: tuple[InputKind, ...] = ()
    plain: bool = False
    fault: bool = False
    counted: bool = False
    neutral: float = 0.0
    notable: float = 0.0
    notable_most: float = math.inf
    commoner_nats: float = 0.0
    further_starts: Callable[[Sequence[Signals]], Sequence[Mapping[str, float]]] | None = None

    def __repr__(self) -> str:
        """Short: id and name."""
        return f"<Effect {self.id}: {self.name}>"

    @property
    def holds_readings(self) -> bool:
        """Whether readings are those of an earlier moment, anywhere in a span: they scatter by themselves."""
        return "scatter" in self.terms and "pace" not in self.terms

    def takes(self, kind: InputKind) -> bool:
        """Whether it makes sense under this kind of input; a servo's loop commands a power."""
        return not self.inputs or ("power_pct" if kind in GOALS else kind) in self.inputs
