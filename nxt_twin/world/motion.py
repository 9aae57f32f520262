"""How all bodies of a world moved, for eyes: frames over time, and the rays that found an echo."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.mock.body.ultrasonic import UltrasonicBody
from nxt_twin.world.arena import Arena
from nxt_twin.world.assembly import Shape
from nxt_twin.world.senses.asked import Asked
from nxt_twin.world.senses.ultrasonic import UltrasonicSense

EVERY_MS: Final = 40


@final
@dataclass(frozen=True)
class RigidMotion:
    """A rigid body's way.

    Attributes:
        name: such as ``robot/left``.
        shapes: in its own frame.
        place_m: of the frame, shape (samples, 3).
        quaternion: of the frame, x, y, z, w, shape (samples, 4).
    """

    name: str
    shapes: tuple[Shape, ...]
    place_m: FloatArray
    quaternion: FloatArray


@final
class WorldBodies:
    """All rigid bodies of a world that can be seen, the robot's first.

    Args:
        arena: the robot in its scene.
    """

    def __init__(self, arena: Arena) -> None:
        self._arena = arena
        self._sonars = [
            sensor.sensor.distance_cm
            for sensor in arena.body.sensors
            if isinstance(sensor, Asked) and isinstance(sensor.sensor, UltrasonicBody)
        ]
        named = [(f"robot/{link.name}", link.shapes) for link in arena.assembly.links]
        scene = arena.setting.scene
        named += [
            (f"things/{name}", scene.things[name].assembly(name).links[0].shapes) for name in arena.things
        ]
        self._shown = [n for n, (_, shapes) in enumerate(named) if shapes]
        self.shapes: list[tuple[str, tuple[Shape, ...]]] = [named[n] for n in self._shown]

    def frames(self) -> list[tuple[float, ...]]:
        """Place (m) and quaternion x, y, z, w of each body now."""
        arena = self._arena
        bodies = [arena.robot, *arena.things.values()]
        every = [frame for body in bodies for frame in arena.engine.frames(body)]
        return [every[n] for n in self._shown]

    def echoes_m(self) -> FloatArray:
        """The ways of the last echoes, shape (rays, 2, 3)."""
        rays = [s.ray_m for s in self._sonars if isinstance(s, UltrasonicSense) and s.ray_m is not None]
        return np.array(rays).reshape(-1, 2, 3)


@final
class Motion:
    """Watches a world from now on, every 40 ms.

    Args:
        arena: the robot in its scene.
    """

    def __init__(self, arena: Arena) -> None:
        self._arena, self._bodies = arena, WorldBodies(arena)
        self._ticks = 0
        self._times: list[float] = []
        self._frames: list[list[tuple[float, ...]]] = []
        self._rays: list[FloatArray] = []
        arena.watchers.append(self._watch)

    @property
    def time_s(self) -> FloatArray:
        """When, shape (samples,)."""
        return np.array(self._times)

    @property
    def rays_m(self) -> list[FloatArray]:
        """For each sample the ways of the last echoes, shape (rays, 2, 3)."""
        return self._rays

    def bodies(self) -> list[RigidMotion]:
        """Every rigid body, the robot's first."""
        shown = self._bodies.shapes
        frames = np.array(self._frames).reshape(len(self._times), len(shown), 7)
        return [
            RigidMotion(name, shapes, frames[:, n, :3], frames[:, n, 3:])
            for n, (name, shapes) in enumerate(shown)
        ]

    def _watch(self) -> None:
        if self._ticks % EVERY_MS == 0:
            self._times.append(self._arena.time_s)
            self._frames.append(self._bodies.frames())
            self._rays.append(self._bodies.echoes_m())
        self._ticks += 1
