"""A LeRobot data set as it stands: its layout is known, so a joint's name is all that a mapping needs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from nxt_twin.errors import MappingError
from nxt_twin.recording.source import quoted
from nxt_twin.recording.tables.lerobot import info_of, is_data_set, joints_of

if TYPE_CHECKING:
    from nxt_twin.recording.mapping import Mapping

_MARK = "#"
_ARM_SERVOS = "servo_sts3215"
_ARMS = ("so100", "so101", "so_", "lekiwi", "bi_so")
"""How the types of robots begin whose joints are Feetech STS3215."""


class Meant(NamedTuple):
    """What of a data set is meant: `FOLDER#elbow_flex`, `FOLDER#3` or `FOLDER#elbow_flex#3`."""

    folder: Path
    joint: str | None
    episode: str


def part_of(path: Path) -> Meant | None:
    """What of a data set a path means; None where it means no data set.

    Raises:
        MappingError: the data set has no such joint.
    """
    name, *marks = path.name.split(_MARK)
    folder = path.parent / name
    if not is_data_set(folder):
        return None
    joints = list(dict.fromkeys(joints_of(folder).values()))
    named = [mark for mark in marks if not mark.isdigit()]
    for mark in named:
        if mark not in joints:
            known = (
                ", ".join(joints) or "not named; write `output: {column: observation.state[0]}` in a mapping"
            )
            raise MappingError(
                f"has no joint {quoted(mark)}", where=str(folder), mend=f"its joints are {known}"
            )
    episode = next((f"{_MARK}{mark}" for mark in marks if mark.isdigit()), "")
    return Meant(folder, named[0] if named else None, episode)


def mapping_of_part(part: Meant) -> Mapping:
    """The mapping of a data set's joint; without a name, of the one that moves most.

    Raises:
        RecordingError: it is no table of numbers.
        MappingError: it lacks what a mapping needs.
    """
    from nxt_twin.recording.guess.guess import guess_mapping  # slow, and few recordings are data sets
    from nxt_twin.recording.mapping import mapping_of

    guessed = guess_mapping(part.folder, part.joint)
    if guessed.lacking is not None:
        raise guessed.lacking
    return mapping_of(guessed.keys, str(part.folder))


def plant_of_part(part: Meant) -> str | None:
    """The plant of the robot's joints, where its type tells which servos it has."""
    robot = str(info_of(part.folder).get("robot_type", "")).lower()
    return _ARM_SERVOS if robot.startswith(_ARMS) else None
