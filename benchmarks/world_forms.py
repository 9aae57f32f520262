"""A robot's world against closed forms: each motion that has one, run in the engine, beside what it should be."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.mock.body.world import World
from nxt_twin.mock.named import world_file
from nxt_twin.world.arena import Arena, open_arena
from nxt_twin.world.assembly import Assembly, Grip, Joint, RigidLink, Shape, lumped
from nxt_twin.world.bullet import GRAVITY_M_S2 as G
from nxt_twin.world.bullet import STEP_S, Bullet
from nxt_twin.world.load import setting_of
from nxt_twin.world.pose import Pose

MOTOR: Final = {
    "resistance": 7.6,
    "constant": 0.4908,
    "coulomb": 8.45e-3,
    "viscous": 1.92e-3,
    "inertia": 1.2e-3,
}
_CONES_DEG: Final = (0.0, 22.5, 45.0)
_SMOOTH: Final = Grip()


@dataclass(frozen=True)
class Form:
    """One number of one motion.

    Attributes:
        what: the motion and the number.
        unit: its unit.
        is_: as the engine has it.
        should: as the closed form has it.
        within: by how much they may differ, in the unit.
    """

    what: str
    unit: str
    is_: float
    should: float
    within: float


def free_fall() -> Iterator[Form]:
    """A ball falls for half a second."""
    engine, ball = _alone(Shape("sphere", (0.02,)), height_m=3.0)
    _steps(engine, 500)
    fallen_m = 3.0 - float(engine.pose(ball).at_m[2])
    yield Form("free fall for 0.5 s", "m", fallen_m, 0.5 * G * 0.25, 0.004)


def rolling() -> Iterator[Form]:
    """A ball rolls down a slope of 5 degrees without slipping: 5/7 of what it would slide."""
    slope = math.radians(5.0)
    gravity = (math.sin(slope), 0.0, -math.cos(slope))
    engine, ball = _alone(Shape("sphere", (0.025,)), height_m=0.025, grip=Grip(0.9), gravity=gravity)
    _steps(engine, 1000)
    yield Form(
        "rolling down 5° for 1 s",
        "m",
        float(engine.pose(ball).at_m[0]),
        0.5 * 5 / 7 * G * math.sin(slope),
        0.002,
    )


def braking() -> Iterator[Form]:
    """A box slides to rest from 1 m/s on a friction of 0.4."""
    engine, box = _alone(Shape("box", (0.1, 0.1, 0.02)), height_m=0.01, grip=Grip(0.4))
    _steps(engine, 100)
    began_m = engine.pose(box).at_m[0]
    _launch(engine, box, (1.0, 0.0, 0.0))
    _steps(engine, 1000)
    yield Form(
        "braking from 1 m/s, friction 0.4",
        "m",
        float(engine.pose(box).at_m[0] - began_m),
        1 / (0.8 * G),
        0.002,
    )


def friction_cone() -> Iterator[Form]:
    """A box that slides is braked alike in every direction."""
    for angle_deg in _CONES_DEG:
        engine, box = _alone(Shape("box", (0.1, 0.1, 0.02)), height_m=0.01, grip=Grip(0.5))
        _steps(engine, 100)
        turn = math.radians(angle_deg)
        _launch(engine, box, (math.cos(turn), math.sin(turn), 0.0))
        _steps(engine, 100)
        speed = float(np.linalg.norm(engine.velocity(box)[0][:2]))
        yield Form(
            f"friction cone at {angle_deg:g}°, friction 0.5", "m/s²", (1.0 - speed) / 0.1, 0.5 * G, 0.075
        )


def pendulum() -> Iterator[Form]:
    """A bar on a hinge swings with a small amplitude."""
    bar = Shape("box", (0.01, 0.01, 0.2), (0.0, 0.0, -0.1))
    joint = Joint("hinge", (0.0, 0.0, 1.0), (0.0, 1.0, 0.0))
    swinging = lumped("bar", [(bar, 0.05)], joint=joint)
    base = lumped("base", [(Shape("box", (0.02, 0.02, 0.02), (0.0, 0.1, 1.0)), 1.0)])
    engine = Bullet(
        gravity=(math.sin(0.05), 0.0, -math.cos(0.05))
    )  # it starts 0.05 rad from where it would hang
    body = engine.add(Assembly("pendulum", (base, swinging), fixed=True), _at((0.0, 0.0, 0.0)))
    engine.drive(body, ["bar"])
    joints, places = np.zeros((1, 2)), []
    for _ in range(3000):
        engine.step()
        engine.joints(joints)
        places.append(joints[0, 0])
    crossings = _crossings(np.array(places) + 0.05)
    inertia = swinging.inertia_kg_m2[1] + 0.05 * 0.1**2
    period_s = 2.0 * math.pi * math.sqrt(inertia / (0.05 * G * 0.1)) * (1.0 + 0.05**2 / 16.0)
    yield Form("pendulum's period", "s", float(np.mean(np.diff(crossings))), period_s, 0.002)


def spin_up() -> Iterator[Form]:
    """A motor with a lifted wheel starts at 60 % of a stiff battery."""
    arena = _stiff("bench")
    wheel: RigidLink = arena.setting.robot.assembly({"a": 0.0}).links[1]
    arena.body.set_motor(0, 60, brake=True)
    angles = []
    for _ in range(700):
        arena.body.step()
        angles.append(arena.body.motors.angles_rad()[0])
    m, inertia = MOTOR, MOTOR["inertia"] + wheel.inertia_kg_m2[1]
    damping = m["constant"] ** 2 / m["resistance"] + m["viscous"]
    torque = 0.6 * 8.0 * m["constant"] / m["resistance"] - m["coulomb"]
    final, time_constant_s = torque / damping, inertia / damping
    speed = (angles[-1] - angles[-101]) / (100 * STEP_S)
    # The angle lags what the final speed would have made of it. The engine moves by the speed at a step's end, which is
    # half a step too much.
    lag_s = 0.7 - angles[-1] / speed + 0.5 * STEP_S
    winding_s = 4.88e-3 / m["resistance"] * (m["viscous"] + m["coulomb"] / final) / damping
    yield Form("lifted wheel's speed at 60 % of 8 V", "rad/s", speed, final, 0.005 * final)
    yield Form(
        "its time constant", "ms", 1e3 * lag_s, 1e3 * (time_constant_s + winding_s), 5.0 * time_constant_s
    )


def straight_drive() -> Iterator[Form]:
    """A castor bot drives ahead for three seconds with both motors at 40 %."""
    arena = _stiff("playground")
    _run(arena, 300, 0, 0)
    start = arena.robot_pose().at_m
    hubs = arena.body.motors.angles_rad()[1]
    _run(arena, 3000, 40, 40)
    end = arena.robot_pose().at_m
    rolled_m = 0.028 * (arena.body.motors.angles_rad()[1] - hubs)
    yield Form(
        "straight drive, travel by wheel angle", "m", float(end[0] - start[0]), rolled_m, 0.01 * rolled_m
    )
    yield Form("straight drive, drift to the side", "m", float(end[1] - start[1]), 0.0, 6e-4 * rolled_m)


def on_the_spot() -> Iterator[Form]:
    """A castor bot turns on the spot for two seconds."""
    arena = _stiff("playground")
    _run(arena, 300, 0, 0)
    total_deg, before = 0.0, arena.robot_pose().heading_deg
    hubs = np.array(arena.body.motors.angles_rad())
    for power in (*range(1, 16), *[15] * 185):
        _run(arena, 10, -power, power)
        now = arena.robot_pose().heading_deg
        total_deg, before = total_deg + (now - before + 180.0) % 360.0 - 180.0, now
    _, left, right = np.array(arena.body.motors.angles_rad()) - hubs
    effective_mm = 28.0 * (right - left) / math.radians(total_deg)
    yield Form("turning on the spot, effective track", "mm", effective_mm, 103.0, 1.0)


def sticking() -> Iterator[Form]:
    """An arm whose weight is less than its motor's friction stays where it is for ten seconds."""
    arena = _stiff("playground", scene={"slope_deg": 1.5, "uphill_deg": 0.0})
    _run(arena, 300, 0, 0)
    before = arena.body.motors.angles_rad()[1]
    _run(arena, 10_000, 0, 0)
    crept = math.degrees(arena.body.motors.angles_rad()[1] - before) * 6.0
    yield Form("creep of a held wheel on a slope of 1.5°", "deg/min", crept, 0.0, 0.02)


FORMS: Final[tuple[Callable[[], Iterator[Form]], ...]] = (
    free_fall,
    rolling,
    braking,
    friction_cone,
    pendulum,
    spin_up,
    straight_drive,
    on_the_spot,
    sticking,
)


def report() -> list[str]:
    """The table, as lines to print."""
    rows = [form for motion in FORMS for form in motion()]
    head = f"{'world: a motion':44}{'engine':>12}{'closed form':>13}{'may differ':>12}  unit"
    return [head, *(_line(row) for row in rows)]


def _line(row: Form) -> str:
    held = "" if abs(row.is_ - row.should) <= row.within else "  OUT"
    return f"{row.what:44}{row.is_:12.5f}{row.should:13.5f}{row.within:12.5f}  {row.unit}{held}"


def _at(place_m: tuple[float, float, float]) -> Pose:
    return Pose(np.array(place_m), np.eye(3))


def _alone(shape: Shape, height_m: float, grip: Grip = _SMOOTH, **engine: Any) -> tuple[Bullet, int]:  # noqa: ANN401
    world = Bullet(**engine)
    return world, world.add(
        Assembly("body", (lumped("body", [(shape, 0.1)], grip),)), _at((0.0, 0.0, height_m))
    )


def _steps(engine: Bullet, count: int) -> None:
    for _ in range(count):
        engine.step()


def _launch(engine: Bullet, body: int, velocity: tuple[float, float, float]) -> None:
    client, number = engine.client
    client.resetBaseVelocity(body, velocity, physicsClientId=number)


def _crossings(values: FloatArray) -> FloatArray:
    """When values fall through zero, s."""
    n = np.flatnonzero((values[:-1] > 0.0) & (values[1:] <= 0.0))
    return (n + 1.0 + values[n] / (values[n] - values[n + 1])) * STEP_S


def _stiff(world: str, **more: Any) -> Arena:  # noqa: ANN401
    """One of the tool's worlds with a battery of 8 V that gives whatever is asked of it."""
    from nxt_twin.mock.body.world import load_world

    file = world_file(world)
    given = load_world(file).model_dump(exclude_unset=True)
    cells = {"voltage_v": 8.0, "internal_resistance_ohm": 0.0, "drain_v_per_c": 0.0}
    return open_arena(setting_of(World.model_validate({**given, "battery": cells, **more}), file))


def _run(arena: Arena, ticks: int, left: int, right: int) -> None:
    for port, power in ((1, left), (2, right)):
        arena.body.set_motor(port, power, brake=True)
    for _ in range(ticks):
        arena.body.step()


if __name__ == "__main__":
    print("\n".join(report()))
