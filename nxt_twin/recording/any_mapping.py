"""A mapping of either kind: of one motor, or of a robot on two wheels."""

from __future__ import annotations

from collections.abc import Mapping as MappingType
from pathlib import Path
from typing import Any

from nxt_twin.errors import MappingError
from nxt_twin.recording.mapping import Mapping
from nxt_twin.recording.robot_keys import is_robots
from nxt_twin.recording.robot_mapping import RobotMapping
from nxt_twin.recording.yaml_file import read_part, read_yaml
from nxt_twin.recording.yaml_place import YamlPlace

AnyMapping = Mapping | RobotMapping
MAPPING_KEYS: frozenset[str] = frozenset((*Mapping.model_fields, *RobotMapping.model_fields))
"""Every key that a mapping may have."""


def read_any_mapping(path: Path) -> AnyMapping:
    """Read a mapping file.

    Raises:
        MappingError: if it is no YAML, or has an unknown key, kind or unit, or lacks one that is needed.
    """
    keys = read_yaml(path, MappingError)
    if "plant" in keys:
        mend = "write `plant:` into NAME.yaml beside the table, which needs no option, or into case.yaml"
        raise MappingError("a mapping names no plant", where=f"{path}, key plant", mend=mend)
    return _read(keys, YamlPlace(path))


def any_mapping_of(keys: MappingType[str, Any], where: str) -> AnyMapping:
    """A mapping from its keys, `where` being the place that a refusal names.

    Raises:
        MappingError: as `read_any_mapping`.
    """
    return _read(dict(keys), where)


def _read(keys: dict[str, Any], where: YamlPlace | str) -> AnyMapping:
    if is_robots(keys):
        return read_part(keys, RobotMapping, MappingError, where=where)
    return read_part(keys, Mapping, MappingError, where=where)
