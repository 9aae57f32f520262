"""The declaration of a base model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

from nxt_twin.physics.parameter import Frame, Parameter

DriveTerm = Callable[..., tuple[float, float]]
"""Gives (torque at zero speed, damping of the drive) for a step, from the command and the electrical state."""


@final
@dataclass(frozen=True)
class Base:
    """A base model: its kind in plant files, its own parameters and its drive.

    The symbols of the drive's arguments are quantities of the step or symbols of `parameters`;
    the first parameter is the inertia. `current_after` gives the winding current (A) at the end of a step, None
    for a plant without a winding. `drawn_by_others` gives the other motors' current at
    the supply's open-circuit voltage (A), and its fall for each volt of sag (S). It is
    None for a plant without a supply. `control` gives the duty from the goal, None where the command is the duty.
    `delay` names the parameter by which commands act late.
    """

    kind: str
    frames: tuple[Frame, ...]
    parameters: tuple[Parameter, ...]
    drive: DriveTerm
    current_after: Callable[..., float] | None = None
    drawn_by_others: Callable[..., tuple[float, float]] | None = None
    control: Callable[..., float] | None = None
    delay: str | None = None
