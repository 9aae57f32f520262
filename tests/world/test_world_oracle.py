"""MuJoCo behind the seam between motors and world: another engine, the same torques in and angles out."""

from __future__ import annotations

import numpy as np
import pytest

from nxt_twin.mock.body.motors import MotorBank
from nxt_twin.recording.columns import PORTS
from nxt_twin.world.arena import open_arena
from nxt_twin.world.assembly import Assembly, RigidLink
from nxt_twin.world.load import load_setting
from nxt_twin.world.plants import WorldPlants

mujoco = pytest.importorskip("mujoco")
STEP_S = 1e-3


def numbers(values) -> str:
    return " ".join(repr(float(value)) for value in values)


def geometry(link: RigidLink) -> str:
    found = []
    for shape in link.shapes:
        if shape.solid and shape.kind == "sphere":
            grip = numbers((link.grip.sliding, link.grip.spinning_m, 0.0))
            found.append(
                f'<geom type="sphere" size="{shape.size_m[0]!r}" pos="{numbers(shape.at_m)}" friction="{grip}" '
                'condim="4"/>'
            )
    return "".join(found)


def inertial(link: RigidLink) -> str:
    # A wheel with its share of a gear train has moments that no body has: the rest is the joint's armature.
    x, y, z = link.inertia_kg_m2
    moments = numbers((x, min(y, x + z), z))
    return f'<inertial pos="{numbers(link.centre_m)}" mass="{link.mass_kg!r}" diaginertia="{moments}"/>'


def body(link: RigidLink) -> str:
    joint = link.joint
    assert joint is not None
    x, y, z = link.inertia_kg_m2
    armature = max(y - (x + z), 0.0)
    hinge = (
        f'<joint name="{link.name}" axis="{numbers(joint.axis)}" armature="{armature!r}"/>'
        if joint.kind == "hinge"
        else ""
    )
    return (
        f'<body name="{link.name}" pos="{numbers(joint.at_m)}">{inertial(link)}{hinge}{geometry(link)}</body>'
    )


def mjcf(assembly: Assembly) -> str:
    base, *links = assembly.links
    gears = "".join(
        f'<joint joint1="{gear.follower}" joint2="{gear.leader}" polycoef="0 {gear.ratio} 0 0 0" solref="0.002 1"/>'
        for gear in assembly.gears
    )
    return (
        f'<mujoco><option timestep="{STEP_S}" gravity="0 0 -9.81" cone="elliptic" impratio="20"/><worldbody>'
        '<geom type="plane" size="5 5 1" friction="0 0 0" priority="-1"/>'
        f'<body name="base"><freejoint/>{inertial(base)}{"".join(body(link) for link in links)}</body>'
        f"</worldbody><equality>{gears}</equality></mujoco>"
    )


class MuJoCo:
    """As much of an engine as motors need."""

    step_s = STEP_S

    def __init__(self, assembly: Assembly, driven: list[str]) -> None:
        self.model = mujoco.MjModel.from_xml_string(mjcf(assembly))
        self.data = mujoco.MjData(self.model)
        joints = [self.model.joint(name) for name in driven]
        self.dofs = [int(joint.dofadr[0]) for joint in joints]
        self.places = [int(joint.qposadr[0]) for joint in joints]

    def joints(self, into: np.ndarray) -> None:
        into[:, 0], into[:, 1] = self.data.qpos[self.places], self.data.qvel[self.dofs]

    def exert(self, exerted: np.ndarray) -> None:
        self.data.qfrc_applied[self.dofs] = exerted[:, 0]
        self.model.dof_frictionloss[self.dofs] = exerted[:, 1]

    def step(self) -> None:
        mujoco.mj_step(self.model, self.data)


def course(motors: MotorBank, left: int, right: int) -> list[float]:
    for port, power in ((1, left), (2, right)):
        motors.set(port, power, brake=True)
    for _ in range(1000):
        motors.step(8.0, STEP_S)
    return motors.angles_rad()[1:]


def test_another_engine_drives_the_castor_bot_alike():
    setting = load_setting("playground")
    arena = open_arena(setting)
    oracle = MuJoCo(arena.assembly, ["left", "right"])
    plants = [setting.world.plant(port, setting.file.parent) for port in PORTS]
    other = MotorBank(WorldPlants(plants, oracle, [1, 2], lambda: None))
    for left, right in ((40, 40), (30, 45)):
        ours, theirs = course(arena.body.motors, left, right), course(other, left, right)
        assert ours == pytest.approx(theirs, rel=0.01)
    place = oracle.data.qpos[:2]
    assert arena.robot_pose().at_m[:2] == pytest.approx(place, abs=0.01)
