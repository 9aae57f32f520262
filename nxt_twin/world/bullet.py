"""PyBullet behind `Engine`. Its settings were found by trial."""

from __future__ import annotations

import os
import sys
import tempfile
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.mock.errors import WorldError
from nxt_twin.world.assembly import Assembly, Gear, RigidLink, Vector
from nxt_twin.world.engine import Body, Hit, Hits
from nxt_twin.world.pose import Pose, quaternion_to_matrix
from nxt_twin.world.urdf import robot_urdf

STEP_S: Final = 1e-3
GRAVITY_M_S2: Final = 9.81
_ITERATIONS: Final = 20
_ITERATIONS_HELD: Final = 60
"""While all motors stand: with 20 a wheel that friction holds on a slope creeps by 0.3 deg a minute."""
_STANDING_RAD_S: Final = 0.02
_RESIDUAL: Final = 1e-10
"""With the default of 1e-7 a motor that is held by friction creeps by a degree a minute."""
_FASTEST_RAD_S: Final = 1e5
_SPRING_LAG_S: Final = 0.005
"""A plunger's damping, as the time by which its spring's force leads."""
_HARD_N: Final = 1e4
_LOOSE: Final = 1
"""The group of what moves, apart from a robot's own parts."""
_OWN: Final = 2
_FIXED: Final = 4
"""The group of what never moves. It has no contact with its own kind, which would cost half of a step."""
_SEEN: Final = _LOOSE | _FIXED
"""What rays hit."""
_MOVING: Final = _LOOSE | _OWN
_ALL: Final = _MOVING | _FIXED


@cache
def pybullet_module() -> Any:  # noqa: ANN401 - an untyped library
    """PyBullet, which says nothing while it is imported.

    Raises:
        WorldError: it is not installed.
    """
    try:
        with _quiet():
            import pybullet
    except ImportError:
        mend = "pip install 'nxt-twin[world]', on Python 3.11"
        raise WorldError("a robot's world needs PyBullet, which is not installed", mend=mend) from None
    return pybullet


@contextmanager
def _quiet() -> Iterator[None]:
    """Send what a compiled library prints nowhere."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = [os.dup(number) for number in (1, 2)]
    try:
        with Path(os.devnull).open("wb") as nowhere:
            for number in (1, 2):
                os.dup2(nowhere.fileno(), number)
        yield
    finally:
        for number, copy in zip((1, 2), kept, strict=True):
            os.dup2(copy, number)
            os.close(copy)


@final
class Bullet:
    """A world of its own, empty but for a level floor.

    Args:
        floor_friction: what the grips of all that stands on the floor are multiplied by.
        gravity: its direction, a unit vector; a slope is a gravity that leans.

    Raises:
        WorldError: PyBullet is not installed.
    """

    def __init__(self, floor_friction: float = 1.0, gravity: Vector = (0.0, 0.0, -1.0)) -> None:
        self._p = p = pybullet_module()
        self._id = p.connect(p.DIRECT)
        self._closing = weakref.finalize(self, p.disconnect, self._id)
        self._links: dict[Body, dict[str, int]] = {}
        self._centres: dict[Body, FloatArray] = {}
        self._driven: tuple[Body, list[int]] = (-1, [])
        self._friction: list[float] = []
        self._held = True
        self._springs: list[tuple[int, float, float]] = []
        self._moved: list[int] = []
        self._sprung: list[tuple[float, ...]] = []
        p.setTimeStep(STEP_S, physicsClientId=self._id)
        p.setGravity(*(GRAVITY_M_S2 * part for part in gravity), physicsClientId=self._id)
        p.setPhysicsEngineParameter(
            numSolverIterations=_ITERATIONS_HELD,
            solverResidualThreshold=_RESIDUAL,
            enableConeFriction=1,
            deterministicOverlappingPairs=1,
            physicsClientId=self._id,
        )
        plane = p.createCollisionShape(p.GEOM_PLANE, physicsClientId=self._id)
        self.floor: Body = p.createMultiBody(0.0, plane, physicsClientId=self._id)
        p.setCollisionFilterGroupMask(self.floor, -1, _FIXED, _MOVING, physicsClientId=self._id)
        p.changeDynamics(
            self.floor,
            -1,
            lateralFriction=floor_friction,
            spinningFriction=0.0,
            rollingFriction=0.0,
            physicsClientId=self._id,
        )

    @property
    def step_s(self) -> float:
        """The length of a step, s."""
        return STEP_S

    @property
    def client(self) -> tuple[Any, int]:
        """The library and the number of this world in it, for pictures."""
        return self._p, self._id

    def add(self, assembly: Assembly, pose: Pose, *, own: bool = False) -> Body:
        """Put bodies into the world at rest; rays pass through what is a robot's `own`."""
        p = self._p
        with tempfile.TemporaryDirectory(prefix="nxt-twin-") as folder:
            path = Path(folder) / "assembly.urdf"
            path.write_text(robot_urdf(assembly), encoding="utf-8")
            with _quiet():
                body: Body = p.loadURDF(
                    str(path),
                    basePosition=pose.at_m.tolist(),
                    baseOrientation=_quaternion(pose.turn),
                    useFixedBase=assembly.fixed,
                    flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER,
                    physicsClientId=self._id,
                )
        names = [assembly.links[0].name]
        for joint in range(p.getNumJoints(body, physicsClientId=self._id)):
            names.append(p.getJointInfo(body, joint, physicsClientId=self._id)[12].decode())
        self._links[body] = {name: number - 1 for number, name in enumerate(names)}
        self._centres[body] = np.array(assembly.links[0].centre_m)
        group = _OWN if own else _FIXED if assembly.fixed and len(assembly.links) == 1 else _LOOSE
        for link in assembly.links:
            self._prepare(body, link, group)
        for gear in assembly.gears:
            self._mesh(body, gear)
        # In a call of their own: with any of these PyBullet takes everything else for the base's.
        p.changeDynamics(
            body,
            -1,
            linearDamping=0.0,
            angularDamping=0.0,
            maxJointVelocity=_FASTEST_RAD_S,
            physicsClientId=self._id,
        )
        return body

    def _prepare(self, body: Body, link: RigidLink, group: int) -> None:
        p, number = self._p, self._links[body][link.name]
        p.changeDynamics(
            body,
            number,
            localInertiaDiagonal=link.inertia_kg_m2,
            lateralFriction=link.grip.sliding,
            spinningFriction=link.grip.spinning_m,
            rollingFriction=link.grip.rolling_m,
            restitution=0.0,
            jointDamping=0.0,
            physicsClientId=self._id,
        )
        meets = _MOVING if group == _FIXED else _ALL
        p.setCollisionFilterGroupMask(body, number, group, meets, physicsClientId=self._id)
        if number >= 0 and link.joint is not None and link.joint.kind != "fixed":
            p.setJointMotorControl2(body, number, p.VELOCITY_CONTROL, force=0.0, physicsClientId=self._id)

    def _mesh(self, body: Body, gear: Gear) -> None:
        p, links = self._p, self._links[body]
        held = p.createConstraint(
            body, links[gear.follower], body, links[gear.leader], p.JOINT_GEAR,
            jointAxis=[0, 1, 0], parentFramePosition=[0, 0, 0], childFramePosition=[0, 0, 0],
            physicsClientId=self._id,
        )  # fmt: skip
        p.changeConstraint(held, gearRatio=-gear.ratio, maxForce=_HARD_N, erp=0.2, physicsClientId=self._id)

    def drive(self, body: Body, links: list[str]) -> None:
        """Name the joints that `joints` gives and `exert` takes, in this order; all others move freely."""
        self._driven = (body, [self._links[body][link] for link in links])
        self._moved = list(self._driven[1])
        self._friction = []

    def joints(self, into: FloatArray) -> None:
        """The driven joints' angles (rad) and speeds (rad/s), into an array of shape (joints, 2)."""
        body, numbers = self._driven
        states = self._p.getJointStates(body, self._moved, physicsClientId=self._id)
        states, self._sprung = states[: len(numbers)], states[len(numbers) :]
        into[:] = [state[:2] for state in states]
        held = all(abs(state[1]) < _STANDING_RAD_S for state in states)
        if held != self._held:
            self._held = held
            iterations = _ITERATIONS_HELD if held else _ITERATIONS
            self._p.setPhysicsEngineParameter(numSolverIterations=iterations, physicsClientId=self._id)

    def exert(self, exerted: FloatArray) -> None:
        """Torque (N·m) in the next step, and the torque to which dry friction holds; shape (joints, 2)."""
        p, (body, numbers) = self._p, self._driven
        if not self._moved:
            return
        torque, friction = exerted.T.tolist()
        for (_, preload_n, stiffness), (place_m, speed, *_) in zip(self._springs, self._sprung, strict=True):
            torque.append(preload_n - stiffness * (place_m + _SPRING_LAG_S * speed))
        p.setJointMotorControlArray(
            body, self._moved, p.TORQUE_CONTROL, forces=torque, physicsClientId=self._id
        )
        if friction != self._friction:  # unlike a torque, it stays in force
            self._friction = friction
            p.setJointMotorControlArray(
                body, numbers, p.VELOCITY_CONTROL, forces=friction, physicsClientId=self._id
            )

    def spring(self, body: Body, link: str, preload_n: float, stiffness_n_per_m: float) -> None:
        """Push a sliding joint of the driven body out by a spring, whenever `exert` is called from now on."""
        number = self._links[body][link]
        self._springs.append((number, preload_n, stiffness_n_per_m))
        self._moved.append(number)
        self._sprung = [*self._sprung, self._p.getJointState(body, number, physicsClientId=self._id)]

    def slide_m(self, body: Body, link: str) -> float:
        """A sliding joint's place, m."""
        state = self._p.getJointState(body, self._links[body][link], physicsClientId=self._id)
        return float(state[0])

    def grip(self, body: Body, link: str, sliding: float) -> None:
        """Change the friction of a link's surface."""
        self._p.changeDynamics(
            body, self._links[body][link], lateralFriction=sliding, physicsClientId=self._id
        )

    def step(self) -> None:
        """Let one step pass."""
        self._p.stepSimulation(physicsClientId=self._id)

    def pose(self, body: Body) -> Pose:
        """Where an assembly's base is; PyBullet itself gives its centre of mass."""
        place, quaternion = self._p.getBasePositionAndOrientation(body, physicsClientId=self._id)
        turn = quaternion_to_matrix(quaternion)
        return Pose(np.array(place) - turn @ self._centres[body], turn)

    def frames(self, body: Body) -> list[tuple[float, ...]]:
        """The frames of an assembly's links, the base's first: place (m) and quaternion x, y, z, w of each."""
        place = self.pose(body).at_m.tolist()
        base = (*place, *self._p.getBasePositionAndOrientation(body, physicsClientId=self._id)[1])
        numbers = [number for number in self._links[body].values() if number >= 0]
        if not numbers:
            return [base]
        states = self._p.getLinkStates(body, numbers, physicsClientId=self._id)
        return [base, *((*state[4], *state[5]) for state in states)]

    def link_place_m(self, body: Body, link: str) -> FloatArray:
        """Where a link's centre of mass is, shape (3,)."""
        return np.array(
            self._p.getLinkState(body, self._links[body][link], physicsClientId=self._id)[0], dtype=np.float64
        )

    def velocity(self, body: Body) -> tuple[FloatArray, FloatArray]:
        """A base's velocity at its centre of mass (m/s) and rate of turn (rad/s), in the world, shape (3,) each."""
        straight, turning = self._p.getBaseVelocity(body, physicsClientId=self._id)
        return np.array(straight), np.array(turning)

    def cast(self, start_m: FloatArray, end_m: FloatArray) -> Hits:
        """Send rays; both of shape (rays, 3). They see no robot's own parts."""
        rows = self._p.rayTestBatch(
            start_m.tolist(),
            end_m.tolist(),
            numThreads=1,
            collisionFilterMask=_SEEN,
            physicsClientId=self._id,
        )
        bodies, _, shares, places, normals = zip(*rows, strict=True)
        return Hits(np.array(bodies), np.array(shares), np.array(places), np.array(normals))

    def look(self, start_m: FloatArray, end_m: FloatArray) -> Hit:
        """Send one ray; both of shape (3,)."""
        body, _, share, place, _ = self._p.rayTest(
            start_m.tolist(), end_m.tolist(), collisionFilterMask=_SEEN, physicsClientId=self._id
        )[0]
        return Hit(body, share, np.array(place))

    def close(self) -> None:
        """Let go of it all; closing again does nothing."""
        self._closing()


def _quaternion(turn: FloatArray) -> list[float]:
    """The unit quaternion x, y, z, w of a rotation matrix."""
    from scipy.spatial.transform import Rotation

    quaternion: list[float] = Rotation.from_matrix(turn).as_quat().tolist()
    return quaternion
