"""World files and robot files, read and checked."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar, final

from pydantic import BaseModel

from nxt_twin.mock.body.world import World, load_world
from nxt_twin.mock.errors import WorldError
from nxt_twin.mock.named import YAML, named, world_file
from nxt_twin.recording.source import quoted
from nxt_twin.recording.yaml_file import read_model, read_part, read_yaml
from nxt_twin.recording.yaml_place import YamlPlace
from nxt_twin.world.robot import Robot
from nxt_twin.world.scene import Scene

ModelT = TypeVar("ModelT", bound=BaseModel)
_LIKE = "like"
_ROBOT = "robot"


@final
@dataclass(frozen=True)
class Setting:
    """A world file with a robot in it, read whole.

    Attributes:
        world: the brick.
        robot: what it is built into.
        scene: what that stands in.
        file: the world file, beside which the paths in it start.
        robot_at: where the robot is written: in a file of its own, or in the world file.
    """

    world: World
    robot: Robot
    scene: Scene
    file: Path
    robot_at: YamlPlace


def load_setting(path: str | Path) -> Setting:
    """Read a world file that holds a robot.

    Args:
        path: of the file, or the name of one of the tool's own worlds, such as `playground`.

    Raises:
        WorldError: it, or the robot that it names, cannot be read, or there is no robot in it.
    """
    file = world_file(path)
    return setting_of(load_world(file), file)


def setting_of(world: World, file: Path) -> Setting:
    """The robot and the scene of a world that was read from `file`.

    Raises:
        WorldError: they are none.
    """
    if world.robot is None:
        mend = "write robot: castor_bot, or another of configs/robots"
        raise WorldError("holds no robot", where=YamlPlace(file).of((_ROBOT,)), mend=mend)
    robot, robot_at = _robot(world.robot, YamlPlace(file, (_ROBOT,)))
    scene = read_part(world.scene or {}, Scene, WorldError, where=YamlPlace(file, ("scene",)))
    return Setting(world, robot, scene, file, robot_at)


def _robot(given: str | dict[str, Any], place: YamlPlace) -> tuple[Robot, YamlPlace]:
    """The robot that a world names, or holds; one that is `like` another takes from it what it does not say itself."""
    if isinstance(given, str):
        file = _robot_file(given, place)
        return read_model(file, Robot, WorldError), YamlPlace(file)
    changed = dict(given)
    like = changed.pop(_LIKE, None)
    if like is not None:
        changed = changed_by(read_yaml(_robot_file(str(like), place, _LIKE), WorldError), changed)
    return read_part(changed, Robot, WorldError, where=place), place


def _robot_file(given: str, place: YamlPlace, *keys: str) -> Path:
    """The file of a robot that is named at some place of a world file."""
    where = YamlPlace(place.file).of((*place.under, *keys))
    if Path(given).suffix not in YAML:
        return named(given, "robots", where=where)
    beside = place.file.parent / given
    if not beside.is_file():
        raise WorldError(
            f"there is no file {quoted(given)}", where=where, mend="check the name and the folder"
        )
    return beside


def changed_by(robot: dict[str, Any], changes: dict[str, Any]) -> dict[str, Any]:
    """A robot's document with some of its values others: what stands at the same keys is replaced, at any depth."""
    merged = dict(robot)
    for key, value in changes.items():
        old = merged.get(key)
        merged[key] = changed_by(old, value) if isinstance(old, dict) and isinstance(value, dict) else value
    return merged
