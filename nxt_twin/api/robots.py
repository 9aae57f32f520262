"""A robot in the world of a mock brick, watched beside its ghost during a live session."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import replace
from pathlib import Path
from typing import Final, final

from nxt_twin.api.openers import mock_options, open_mock, world_bodies
from nxt_twin.brick.clock import Clock
from nxt_twin.brick.link import Link
from nxt_twin.mock.body.body import Body
from nxt_twin.mock.body.world import World, load_world
from nxt_twin.mock.named import world_file
from nxt_twin.physics.robot.drive import DifferentialDrive
from nxt_twin.recording.case import ROBOT_KIND
from nxt_twin.recording.columns import PORTS, tacho_column
from nxt_twin.recording.configs import configs_dir, load_plant_config
from nxt_twin.twin.beside import diagnosing
from nxt_twin.twin.records import Event, Tick
from nxt_twin.twin.robot_twin import RobotTwin
from nxt_twin.twin.wheel_ghost import RobotReading
from nxt_twin.view.dashboard.scene import (
    DrawnShape,
    SceneFrame,
    Scenery,
    WorldMessage,
    WorldMoment,
    coarse,
)
from nxt_twin.world.arena import Arena, open_arena
from nxt_twin.world.floor import FloorPicture
from nxt_twin.world.load import setting_of
from nxt_twin.world.motion import WorldBodies
from nxt_twin.world.pose import Heading

_LOOK_STEPS: Final = 4
_FRAME_STEPS: Final = 40
_SHOWN_EVERY_S: Final = 0.05
_KEPT: Final = 1000
"""Looks: the last four seconds, in which a poll's counts are found again."""


def usual_robot(url: str) -> str | None:
    """The plant that a `mock:` URL's world has its robot by name or by ``like:``; None where there is none.

    Raises:
        LinkUrlError: the address is not of its form.
        WorldError: the world file cannot be read.
    """
    scheme, _, address = url.partition(":")
    world = mock_options(address).get("world") if scheme == "mock" else None
    if world is None:
        return None
    given = load_world(world_file(world)).robot
    name = given.get("like") if isinstance(given, dict) else given
    known = {file.stem for file in (configs_dir() / "plants").glob("*.yaml")}
    if name not in known or load_plant_config(str(name)).get("kind") != ROBOT_KIND:
        return None
    return str(name)


@final
class WatchedRobot:
    """A session's sink, and the opener of the `mock:` URL whose world it sees the robot in.

    Args:
        drive: the model of the robot's wheels.
        tell: told of what is found.
        executor: where a diagnosis runs; by default beside the session.
    """

    def __init__(
        self, drive: DifferentialDrive, tell: Callable[[Event], None], executor: Executor | None = None
    ) -> None:
        self.twin = RobotTwin(drive, executor or diagnosing())
        self._channels = tuple(tacho_column(port) for port in (drive.left, drive.right))
        self._tell = tell
        self._ports = tuple(PORTS.index(port) for port in (drive.left, drive.right))
        self._arena: Arena | None = None
        self._heading = Heading()
        self._seen: deque[RobotReading] = deque(maxlen=_KEPT)
        self._steps = 0
        self._bodies: WorldBodies | None = None
        self._moment: tuple[tuple[SceneFrame, ...], tuple[SceneFrame, ...]] = ((), ())
        self._shown_s = 0.0
        self._show: Callable[[WorldMessage], None] | None = None

    def show_in(self, show: Callable[[WorldMessage], None]) -> None:
        """Also tell somebody of the world: its scenery when the link opens, then 20 moments a second."""
        self._show = show

    def open(self, address: str, clock: Clock) -> Link:
        """Switch on the mock brick of an address, as `open_mock` does, and keep its world.

        Raises:
            LinkUrlError: the address is not of its form.
            WorldError: the world file is none.
        """
        return open_mock(address, clock, bodies=self._body)

    def _body(self, world: World, file: Path | None, seed: int, *, ready: bool) -> Body:
        if world.robot is None:
            return world_bodies(world, file, seed, ready=ready)
        self._arena = arena = open_arena(setting_of(world, file or Path("world")), seed)
        arena.watchers.append(self._look)
        if self._show is not None:
            self._bodies = WorldBodies(arena)
            self._show(_scenery(arena, self._bodies))
        return arena.body

    def _look(self) -> None:
        self._steps += 1
        if self._arena is None or self._steps % _LOOK_STEPS:
            return
        pose, counts = self._arena.robot_pose(), self._arena.body.tacho_counts()
        x_m, y_m = pose.at_m[:2].tolist()
        left, right = (counts[port] for port in self._ports)
        self._seen.append(RobotReading(self._arena.time_s, left, right, x_m, y_m, self._heading.of(pose)))

        if self._bodies is not None and self._steps % _FRAME_STEPS == 0:
            echoes = self._bodies.echoes_m().reshape(-1, 6).tolist()
            self._moment = tuple(self._bodies.frames()), tuple(map(tuple, echoes))

    def tick(self, tick: Tick) -> None:
        """Compare the robot with its ghost at a poll that read both wheels."""
        counts = {each.channel: each.measured for each in tick.innovations}
        left, right = (counts.get(channel) for channel in self._channels)
        if left is None or right is None or not self._seen:
            return
        # The brick went on after it answered; the counts tell at which moment the poll saw it.
        then = min(
            reversed(self._seen), key=lambda seen: abs(seen.left_deg - left) + abs(seen.right_deg - right)
        )
        while self._seen[0] is not then:  # equal counts of before are of another place
            self._seen.popleft()
        for event in self.twin.see(replace(then, left_deg=left, right_deg=right)):
            self._tell(replace(event, time_s=tick.received_s))
        self._tell_world(tick.received_s)

    def _tell_world(self, now_s: float) -> None:
        frames, echoes = self._moment
        if self._show is None or not frames or now_s - self._shown_s < _SHOWN_EVERY_S:
            return
        self._shown_s = now_s
        pose = self.twin.ghost_pose
        ghost = None if pose is None else (pose[0], pose[1], math.radians(pose[2]))
        self._show(WorldMoment(now_s, frames, echoes, ghost, self.twin.ghosts))

    def event(self, event: Event) -> None:
        """Nothing: the motors' events are the session's."""

    def close(self) -> None:
        """Nothing to finish."""


def _scenery(arena: Arena, bodies: WorldBodies) -> Scenery:
    """What there is to draw of a world."""
    floor = arena.setting.scene.floor
    shades = FloorPicture(floor, arena.setting.file).shades
    drawn = tuple(
        (
            name,
            tuple(
                DrawnShape(one.kind, one.size_m, one.at_m, one.turned_rad, one.colour)
                for one in shapes
                if one.seen
            ),
        )
        for name, shapes in bodies.shapes
    )
    return Scenery((1e-3 * floor.size_mm[0], 1e-3 * floor.size_mm[1]), coarse(shades), drawn)
