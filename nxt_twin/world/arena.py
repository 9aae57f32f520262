"""A robot in its scene, alive: what a world file describes, in an engine, with the brick's body on it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.mock.body.battery import Battery
from nxt_twin.mock.body.body import Body as BrickBody
from nxt_twin.mock.body.motors import MotorBank
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.recording.columns import PORTS, Port
from nxt_twin.recording.yaml_place import YamlPlace
from nxt_twin.world.assembly import Assembly, Vector, rotation
from nxt_twin.world.blame import blaming
from nxt_twin.world.bullet import Bullet
from nxt_twin.world.carpets import Carpets
from nxt_twin.world.engine import Body
from nxt_twin.world.floor import FloorPicture
from nxt_twin.world.load import Setting
from nxt_twin.world.parts import metres, radians
from nxt_twin.world.plants import WorldPlants
from nxt_twin.world.pose import Pose
from nxt_twin.world.scene import Scene
from nxt_twin.world.senses.sockets import sockets
from nxt_twin.world.senses.surroundings import Surroundings


@final
@dataclass(frozen=True)
class Arena:
    """A robot in its scene.

    Attributes:
        setting: what was written.
        engine: the world's physics.
        robot: the robot in it.
        assembly: its links.
        things: the things in it, by name.
        body: the brick's body: advancing it advances all.
        watchers: called after each millisecond.
    """

    setting: Setting
    engine: Bullet
    robot: Body
    assembly: Assembly
    things: dict[str, Body]
    body: BrickBody
    watchers: list[Callable[[], None]]

    @property
    def time_s(self) -> float:
        """Time since power-on, s."""
        return self.body.time_s

    def robot_pose(self) -> Pose:
        """Where the robot's frame is: on the floor, under the middle of its axle."""
        return self.engine.pose(self.robot)

    def thing_pose(self, name: str) -> Pose:
        """Where a thing's middle is."""
        return self.engine.pose(self.things[name])


def open_arena(setting: Setting, seed: int = 0) -> Arena:
    """Build a world file's robot and scene.

    Args:
        setting: what was written.
        seed: of the sensors' noise.

    Raises:
        WorldError: PyBullet is not installed, or what the file says or names cannot be built.
    """
    scene, robot = setting.scene, setting.robot
    engine = Bullet(scene.floor.friction, _downhill(scene))
    things = {
        name: engine.add(thing.assembly(name), _put(thing.at_mm, thing.turned_deg))
        for name, thing in scene.things.items()
    }
    plants = {port: _plant(setting, port) for port in PORTS}
    assembly = robot.assembly(
        {port: plant.values[Slot(BASE_OWNER, "inertia")] for port, plant in plants.items()}
    )
    body = engine.add(assembly, _start(scene), own=True)
    motors = robot.motors
    driven = [port for port in PORTS if port in motors]
    engine.drive(body, [motors[port] for port in driven])
    watchers: list[Callable[[], None]] = []
    if scene.carpets:
        standing = {name: wheel.friction for name, wheel in robot.wheels.items()}
        standing |= {name: glide.friction for name, glide in robot.glides.items()}
        watchers.append(Carpets(scene.carpets, scene.floor.friction, engine, body, standing))

    def after() -> None:
        for watch in watchers:
            watch()

    ports = [PORTS.index(port) for port in driven]
    world_plants = WorldPlants([plants[port] for port in PORTS], engine, ports, after)
    cells = setting.world.battery
    battery = Battery(cells.voltage_v, cells.internal_resistance_ohm, cells.drain_v_per_c)
    floor = FloorPicture(scene.floor, setting.file)
    around = Surroundings(engine, body, things, scene, floor, setting.robot_at)
    brick = BrickBody(
        battery,
        MotorBank(world_plants),
        sockets({int(port): mount for port, mount in robot.sensors.items()}, around, seed),
    )
    return Arena(setting, engine, body, assembly, things, brick, watchers)


def _plant(setting: Setting, port: Port) -> Plant:
    with blaming(YamlPlace(setting.file), "motors", port):
        return setting.world.plant(port, setting.file.parent)


def _downhill(scene: Scene) -> Vector:
    """Where gravity points, the floor being level."""
    slope, uphill = math.radians(scene.slope_deg), math.radians(scene.uphill_deg)
    return (-math.sin(slope) * math.cos(uphill), -math.sin(slope) * math.sin(uphill), -math.cos(slope))


def _put(at_mm: tuple[float, float, float], turned_deg: tuple[float, float, float]) -> Pose:
    return Pose(np.array(metres(at_mm)), rotation(radians(turned_deg)))


def _start(scene: Scene) -> Pose:
    x, y, *height = scene.start.at_mm
    place = (x, y, height[0] if height else 0.0)
    return _put(place, (0.0, scene.start.pitch_deg, scene.start.heading_deg))
