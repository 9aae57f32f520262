"""The interface of a physics engine to this room; narrow, so that another engine can stand behind it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, final

from nxt_twin.arrays import FloatArray
from nxt_twin.world.assembly import Assembly
from nxt_twin.world.pose import Pose

Body = int
"""A handle of what was added to an engine."""


@final
@dataclass(frozen=True)
class Hits:
    """Where rays met something; arrays of shape (rays, …).

    Attributes:
        body: what was hit, -1 for nothing.
        share: of the ray's length at which, 0 to 1.
        at_m: where, shape (rays, 3).
        normal: of the surface, shape (rays, 3).
    """

    body: FloatArray
    share: FloatArray
    at_m: FloatArray
    normal: FloatArray


@final
@dataclass(frozen=True)
class Hit:
    """Where one ray met something.

    Attributes:
        body: what was hit, -1 for nothing.
        share: of the ray's length at which, 0 to 1.
        at_m: where, shape (3,).
    """

    body: Body
    share: float
    at_m: FloatArray


class Engine(Protocol):
    """Rigid bodies in contact, advanced in steps of one length."""

    @property
    def step_s(self) -> float:
        """The length of a step, s."""
        ...

    def add(self, assembly: Assembly, pose: Pose, *, own: bool = False) -> Body:
        """Put bodies into the world at rest; rays pass through what is a robot's `own`."""
        ...

    def drive(self, body: Body, links: list[str]) -> None:
        """Name the joints that `joints` gives and `exert` takes, in this order; all others move freely."""
        ...

    def joints(self, into: FloatArray) -> None:
        """The driven joints' angles (rad) and speeds (rad/s), into an array of shape (joints, 2)."""
        ...

    def exert(self, exerted: FloatArray) -> None:
        """Torque (N·m) in the next step, and the torque to which dry friction holds; shape (joints, 2)."""
        ...

    def spring(self, body: Body, link: str, preload_n: float, stiffness_n_per_m: float) -> None:
        """Push a sliding joint of the driven body out by a spring, whenever `exert` is called from now on."""
        ...

    def slide_m(self, body: Body, link: str) -> float:
        """A sliding joint's place, m."""
        ...

    def grip(self, body: Body, link: str, sliding: float) -> None:
        """Change the friction of a link's surface."""
        ...

    def step(self) -> None:
        """Let one step pass."""
        ...

    def pose(self, body: Body) -> Pose:
        """Where an assembly's base is."""
        ...

    def link_place_m(self, body: Body, link: str) -> FloatArray:
        """Where a link's centre of mass is, shape (3,)."""
        ...

    def velocity(self, body: Body) -> tuple[FloatArray, FloatArray]:
        """A base's velocity at its centre of mass (m/s) and rate of turn (rad/s), in the world, shape (3,) each."""
        ...

    def cast(self, start_m: FloatArray, end_m: FloatArray) -> Hits:
        """Send rays; both of shape (rays, 3)."""
        ...

    def look(self, start_m: FloatArray, end_m: FloatArray) -> Hit:
        """Send one ray; both of shape (3,)."""
        ...

    def close(self) -> None:
        """Let go of it all."""
        ...
