"""The body of a mock brick that is built into a robot."""

from __future__ import annotations

from pathlib import Path

from nxt_twin.mock.body.body import Body
from nxt_twin.mock.body.world import World
from nxt_twin.world.arena import open_arena
from nxt_twin.world.load import setting_of


def robot_body(world: World, file: Path | None, seed: int) -> Body:
    """A brick's body on a robot in its scene, at its start; one of the mock's `Bodies`.

    Raises:
        WorldError: the robot or the scene is none, or PyBullet is not installed.
        PlantError: a motor's plant is none.
    """
    return open_arena(setting_of(world, file or Path("world")), seed).body
