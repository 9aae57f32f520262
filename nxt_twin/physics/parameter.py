"""A physical parameter as an object: name, unit, bounds, prior."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, final

from nxt_twin.physics.signals import Signals

Frame = Literal["motor", "rotary", "linear"]
"""What kind of plant carries the parameter: an NXT-like motor, another rotary plant, or a linear one."""

FRAMES: tuple[Frame, ...] = ("motor", "rotary", "linear")


@final
@dataclass(frozen=True)
class Dimension:
    """How a parameter scales with the plant's torque (or force), speed and current, as exponents of the three.

    With a time of 0.1 s taken for granted, angle scales as speed, inertia as torque over speed. A voltage times a
    current is a power, so a voltage scales as torque times speed over current.
    """

    torque: float = 0.0
    speed: float = 0.0
    current: float = 0.0


NUMBER = Dimension()
TORQUE = Dimension(torque=1.0)
SPEED = Dimension(speed=1.0)
ANGLE = Dimension(speed=1.0)
INERTIA = Dimension(torque=1.0, speed=-1.0)
DAMPING = Dimension(torque=1.0, speed=-1.0)
STIFFNESS = Dimension(torque=1.0, speed=-1.0)
GIVE = Dimension(torque=-1.0, speed=1.0)
DRAG = Dimension(torque=1.0, speed=-2.0)
ENERGY_INVERSE = Dimension(torque=-1.0, speed=-1.0)
CURRENT = Dimension(current=1.0)
CURRENT_INVERSE = Dimension(current=-1.0)
VOLTAGE = Dimension(torque=1.0, speed=1.0, current=-1.0)
RESISTANCE = Dimension(torque=1.0, speed=1.0, current=-2.0)

_LIKE_A_CURRENT = {"A": 1.0, "Ω": -1.0, "H": -1.0, "1/J": -1.0, "1/A": -1.0}


@final
@dataclass(frozen=True)
class Scale:
    """The torque (N·m or N), speed (rad/s or m/s) and current (A) ordinary for a plant, and what was recorded of it."""

    torque: float
    speed: float
    recordings: tuple[Signals, ...] = field(default=(), compare=False, repr=False)
    current: float = 0.53


NXT_SCALE = Scale(torque=0.3, speed=10.0)
"""Half the stall torque, a middling speed and half the stall current of an NXT motor at its output hub."""


@final
@dataclass(frozen=True, repr=False)
class Parameter:
    """One parameter of a base model or of an effect.

    Attributes:
        name: the key in plant files and JSON (docs/effects.md), which ends in the unit.
        symbol: the name under which the equations use its SI value.
        unit: of `name`, for people.
        dimension: how it scales from an NXT motor to another plant.
        starts: values, in `unit` and at NXT scale, from which a fit begins; the first is the typical one.
        lower, upper: bounds in `unit` at NXT scale.
        spread: standard deviation of the weak prior round the first start, as a fraction of it; inf is none.
        doubt: standard deviation of the prior round a value that a plant file gives, as a fraction of it.
        si: factor from `unit` to SI.
        frozen: an anchor that encoder and voltage cannot identify; a fit leaves it alone.
        tied_to: the symbol of another parameter of the same owner, in fixed proportion to which it moves.
        elsewhere: name, unit and, where it is another, the factor to SI in frames other than the motor's.
        otherwise: value, in `unit`, where a plant file leaves it out; None if it must not.
        hints: SI values that recordings themselves suggest to start from, in the place of `starts`.
        hinted_spread: as `spread`, round a start that recordings suggest; None where that is no better known.
        law: how far published laws of this name differ in it: one standard deviation, as a fraction of the value. No
            recording shows which of these laws holds.
        least: SI value up to which it is within what the recordings themselves leave open.
        lowest: SI value below which recordings rule it out, where that is above `lower`.
        above: owner and symbol of the parameter that it has to exceed to make a difference.
        tried: it acts in steps, so that a search tries values and a fit leaves it alone.
        shapes: it shapes a course that has no law, so that its bounds mean nothing.
        shared_out: it is a share of which none and all are as ordinary as a part. A fit moves it as it is, not its
            logarithm, and its bounds mean nothing.
        part_of: symbol of the share, its own or another's, at 0 of which it means nothing and is not fitted.
    """

    name: str
    symbol: str
    unit: str
    dimension: Dimension
    starts: tuple[float, ...]
    lower: float
    upper: float
    spread: float = math.inf
    doubt: float = math.inf
    si: float = 1.0
    frozen: bool = False
    tied_to: str | None = None
    elsewhere: dict[Frame, tuple[str, str] | tuple[str, str, float]] = field(default_factory=dict)
    otherwise: float | None = None
    hints: Callable[[Sequence[Signals]], Sequence[float]] | None = None
    hinted_spread: float | None = None
    law: float = 0.0
    least: Callable[[Sequence[Signals]], float] | None = None
    lowest: Callable[[Sequence[Signals]], float] | None = None
    above: tuple[str, str] | None = None
    tried: bool = False
    shapes: bool = False
    shared_out: bool = False
    part_of: str | None = None

    def __repr__(self) -> str:
        """Short: name and unit."""
        return f"<Parameter {self.name}, {self.unit}>"

    @property
    def likeness(self) -> float:
        """The power with which it grows among motors that angle and voltage cannot tell apart.

        Twice the torques, inertias and currents and half the resistances make the same motion.
        """
        if self.is_electrical:
            return _LIKE_A_CURRENT[self.unit]
        return self.dimension.torque + self.dimension.current

    @property
    def is_bounded(self) -> bool:
        """Whether a value at one of its bounds says that the readings ask for another law."""
        return not (self.shapes or self.shared_out or self.tried)

    @property
    def is_electrical(self) -> bool:
        """Whether its unit holds a current, so that it goes with the winding's resistance among such motors."""
        return self.unit in _LIKE_A_CURRENT

    def is_idle(self, value: float) -> bool:
        """Whether an SI `value` of what a search tries, or of a part or share of none, may be left out of a file."""
        optional = self.tried or self.part_of is not None or self.shared_out
        return optional and self.otherwise is not None and value == self.otherwise * self.si

    def in_frame(self, frame: Frame) -> Parameter:
        """The same parameter under the name and unit that `frame` uses."""
        if frame not in self.elsewhere:
            return self
        name, unit, *other = self.elsewhere[frame]
        si = other[0] if other else self.si
        return replace(
            self,
            name=name,
            unit=unit,
            si=si,
            starts=tuple(start * self.si / si for start in self.starts),
            lower=self.lower * self.si / si,
            upper=self.upper * self.si / si,
            otherwise=None if self.otherwise is None else self.otherwise * self.si / si,
            elsewhere={},
        )

    def scaled(self, scale: Scale) -> Parameter:
        """The same parameter with starts and bounds carried from NXT scale to `scale`."""
        factor = (scale.torque / NXT_SCALE.torque) ** self.dimension.torque
        factor *= (scale.speed / NXT_SCALE.speed) ** self.dimension.speed
        factor *= (scale.current / NXT_SCALE.current) ** self.dimension.current
        hinted = self.hints(scale.recordings) if self.hints and scale.recordings else ()
        known = bool(hinted) and self.hinted_spread is not None
        lower = self.lower * factor
        if self.lowest and scale.recordings:
            lower = max(lower, self.lowest(scale.recordings) / self.si)
        return replace(
            self,
            starts=tuple(value / self.si for value in hinted) or tuple(x * factor for x in self.starts),
            lower=lower,
            upper=self.upper * factor,
            spread=self.hinted_spread if known and self.hinted_spread is not None else self.spread,
        )
