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
class Motion:
    """Watches a world from now on, every 40 ms.

    Args:
        arena: the robot in its scene.
    """

    def __init__(self, arena: Arena) -> None:
        self._arena = arena
        self._ticks = 0
        self._times: list[float] = []
        self._frames: list[list[tuple[float, ...]]] = []
        self._rays: list[FloatArray] = []
        self._sonars = [
            sensor.sensor.distance_cm
            for sensor in arena.body.sensors
            if isinstance(sensor, Asked) and isinstance(sensor.sensor, UltrasonicBody)
        ]
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
        arena = self._arena
        named = [(f"robot/{link.name}", link.shapes) for link in arena.assembly.links]
        scene = arena.setting.scene
        named += [
            (f"things/{name}", scene.things[name].assembly(name).links[0].shapes) for name in arena.things
        ]
        frames = np.array(self._frames).reshape(len(self._times), len(named), 7)
        return [
            RigidMotion(name, shapes, frames[:, n, :3], frames[:, n, 3:])
            for n, (name, shapes) in enumerate(named)
            if shapes
        ]

    def _watch(self) -> None:
        if self._ticks % EVERY_MS == 0:
            arena = self._arena
            self._times.append(arena.time_s)
            bodies = [arena.robot, *arena.things.values()]
            self._frames.append([frame for body in bodies for frame in arena.engine.frames(body)])
            echoes = [s.ray_m for s in self._sonars if isinstance(s, UltrasonicSense) and s.ray_m is not None]
            self._rays.append(np.array(echoes).reshape(-1, 2, 3))
        self._ticks += 1
