"""The formats by name, and what each cannot say."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal, final

from nxt_twin.export.axis import Axis
from nxt_twin.export.mjcf import mjcf
from nxt_twin.export.python_text import python_text
from nxt_twin.export.simscape import simscape_csv
from nxt_twin.export.urdf import urdf

FormatName = Literal["urdf", "mjcf", "simscape-csv", "python"]


@final
@dataclass(frozen=True)
class Format:
    """How to write an axis.

    Attributes:
        write: the text, from the axis and what it is to say about itself.
        limits: what the format, or its program's model, does otherwise than ours.
    """

    write: Callable[[Axis, tuple[str, ...]], str]
    limits: tuple[str, ...]


FORMATS: Final[Mapping[FormatName, Format]] = MappingProxyType(
    {
        "urdf": Format(
            urdf,
            (
                "URDF has no motor: supply, resistance and back EMF are only in the limits of effort and velocity",
                "programs read friction and damping of a joint differently; some ignore both",
            ),
        ),
        "mjcf": Format(
            mjcf,
            (
                "the actuator is a closed winding without inductance: 0 V brakes, and nothing coasts",
                "MuJoCo's dry friction is a soft constraint: where ours sticks, its joint creeps",
            ),
        ),
        "simscape-csv": Format(
            simscape_csv,
            (
                "breakaway and Coulomb torque are equal, as in our plain friction; Simscape rounds the step at rest",
            ),
        ),
        "python": Format(
            python_text,
            ("pulses are their mean voltage: the ripple of a bridge that floats between them is left out",),
        ),
    }
)


@final
@dataclass(frozen=True)
class Exported:
    """An axis as a text.

    Attributes:
        text: what goes into the file; it names its limits too.
        left_out: ids of the plant's effects that it does not carry.
        limits: what the format does otherwise than our model.
    """

    text: str
    left_out: tuple[str, ...]
    limits: tuple[str, ...]


def export(axis: Axis, name: FormatName) -> Exported:
    """Write an axis in one of the formats."""
    chosen = FORMATS[name]
    told = [f"written by nxt-twin export; {axis.name} at its output hub, SI units"]
    if axis.effects:
        told.append(f"left out, as this format has no such physics: {', '.join(axis.effects)}")
    told += chosen.limits
    return Exported(chosen.write(axis, tuple(told)), axis.effects, chosen.limits)
