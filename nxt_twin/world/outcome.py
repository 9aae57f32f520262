"""What became of a robot and its things, judged from the world alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any, final

import numpy as np

from nxt_twin.world.arena import Arena
from nxt_twin.world.program import Ran
from nxt_twin.world.trace import Trace


@final
@dataclass(frozen=True)
class Ghost:
    """Where a model of its wheels has the robot: x, y (m) and heading (deg)."""

    x_m: float
    y_m: float
    heading_deg: float


@final
@dataclass(frozen=True)
class WorldOutcome:
    """The end of a run.

    Attributes:
        ran: how the program ended.
        wall_s: how long that took.
        x_m, y_m, heading_deg, path_m: where the robot is, by how much it has turned in all, and how far it went.
        upright: the robot stands as it began, within 45 deg.
        hubs_deg: the hubs' angles, by port.
        things_m: where things are that can move.
        ghost: where a model has the robot, if one was asked.
    """

    ran: Ran
    wall_s: float
    x_m: float
    y_m: float
    heading_deg: float
    path_m: float
    upright: bool
    hubs_deg: dict[str, float]
    things_m: dict[str, tuple[float, float, float]]
    ghost: Ghost | None = None

    @property
    def apart_mm(self) -> float:
        """How far robot and ghost are apart; 0 without a ghost."""
        ghost = self.ghost
        return 0.0 if ghost is None else 1e3 * float(np.hypot(ghost.x_m - self.x_m, ghost.y_m - self.y_m))


def outcome(
    arena: Arena, course: Trace, ran: Ran, *, wall_s: float, ghost: Ghost | None = None
) -> WorldOutcome:
    """Look at the world as it is now."""
    pose = arena.robot_pose()
    x_m, y_m = (float(part) for part in pose.at_m[:2])
    hubs = np.degrees(arena.body.motors.angles_rad()).tolist()
    loose = [name for name, thing in arena.setting.scene.things.items() if thing.mass_g is not None]
    return WorldOutcome(
        ran,
        wall_s,
        x_m,
        y_m,
        float(course.column("heading_deg")[-1]),
        course.path_m,
        upright=bool(pose.turn[2, 2] > np.sqrt(0.5)),
        hubs_deg=dict(zip("abc", hubs, strict=True)),
        things_m={name: _place(arena, name) for name in loose},
        ghost=ghost,
    )


def _place(arena: Arena, name: str) -> tuple[float, float, float]:
    x, y, z = arena.thing_pose(name).at_m.tolist()
    return x, y, z


def to_json(told: WorldOutcome) -> dict[str, Any]:
    """The outcome as JSON has it."""
    ghost = None if told.ghost is None else {**asdict(told.ghost), "apart_mm": round(told.apart_mm, 3)}
    return {
        "schema": "nxt-twin/world/1",
        "program": {"ending": told.ran.ending, "said": told.ran.said},
        "elapsed_s": round(told.ran.elapsed_s, 6),
        "times_real_time": round(told.ran.elapsed_s / max(told.wall_s, 1e-9), 2),
        "robot": {
            "x_m": round(told.x_m, 6),
            "y_m": round(told.y_m, 6),
            "heading_deg": round(told.heading_deg, 4),
            "path_m": round(told.path_m, 6),
            "upright": told.upright,
        },
        "ghost": ghost,
        "motors_deg": {port: round(angle, 3) for port, angle in told.hubs_deg.items()},
        "things_m": {name: [round(part, 6) for part in place] for name, place in told.things_m.items()},
    }


def summary(told: WorldOutcome) -> Iterator[str]:
    """The outcome in words."""
    pace = told.ran.elapsed_s / max(told.wall_s, 1e-9)
    yield f"The program: {told.ran.ending} after {told.ran.elapsed_s:.1f} s, {pace:.1f} times as fast as real time."
    yield (
        f"The robot: x {1e3 * told.x_m:.0f} mm, y {1e3 * told.y_m:.0f} mm, turned by {told.heading_deg:.1f} deg, "
        f"after {told.path_m:.2f} m{'' if told.upright else '; it has fallen over'}."
    )
    if told.ghost is not None:
        turned = told.heading_deg - told.ghost.heading_deg
        yield f"Its ghost: {told.apart_mm:.0f} mm away, and the robot is turned {turned:.1f} deg further."
    for name, place in told.things_m.items():
        yield f"{name}: x {1e3 * place[0]:.0f} mm, y {1e3 * place[1]:.0f} mm, z {1e3 * place[2]:.0f} mm"
