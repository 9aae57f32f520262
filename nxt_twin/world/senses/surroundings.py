"""What sensors look at: the engine, the robot that they sit on, the scene and its floor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.yaml_place import YamlPlace
from nxt_twin.world.bullet import Bullet
from nxt_twin.world.engine import Body
from nxt_twin.world.floor import FloorPicture
from nxt_twin.world.pose import Pose
from nxt_twin.world.scene import Scene


@final
@dataclass(frozen=True)
class Surroundings:
    """The world round a robot.

    Attributes:
        engine: its physics.
        robot: the robot in it.
        things: by name.
        scene: what was written.
        floor: what is printed.
        robot_at: where the robot is written; paths of its sensors' configurations start beside that file.
    """

    engine: Bullet
    robot: Body
    things: dict[str, Body]
    scene: Scene
    floor: FloorPicture
    robot_at: YamlPlace

    def pose(self) -> Pose:
        """The robot's."""
        return self.engine.pose(self.robot)

    def model(self, name: str) -> dict[str, Any]:
        """A sensor's configuration by its name, or by a path beside the robot's file.

        Raises:
            PlantError: there is none.
        """
        beside = self.robot_at.file.parent / name
        return load_plant_config(beside if beside.suffix in (".yaml", ".yml") else name)
