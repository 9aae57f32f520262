"""The reference of the keys in files that people write, from the models that read these files."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any, Final

from pydantic import BaseModel

from nxt_twin.experiment.plan import (
    AngleSweep,
    DistanceSweep,
    GradientSweep,
    MotorIdentification,
    TouchCycles,
    TwoSensors,
)
from nxt_twin.fleet.finding.fleet_file import FleetFile
from nxt_twin.mock.body.world import World
from nxt_twin.recording.case import CaseFile
from nxt_twin.recording.mapping import Mapping
from nxt_twin.recording.program import MotorProgram
from nxt_twin.recording.robot_mapping import RobotMapping
from nxt_twin.recording.robot_path import RobotPath
from nxt_twin.world.robot import Robot
from nxt_twin.world.scene import Scene

FILES: Final[dict[str, tuple[type[BaseModel], ...]]] = {
    "Mapping files": (Mapping, RobotMapping),
    "Cases": (CaseFile,),
    "Motor programs": (MotorProgram,),
    "Robot paths": (RobotPath,),
    "World files": (World, Robot, Scene),
    "Experiments": (
        DistanceSweep, AngleSweep, GradientSweep, TouchCycles, TwoSensors, MotorIdentification,
    ),
    "Fleet files": (FleetFile,),
}  # fmt: skip
"""The models by kind of file; plants have no fixed keys and stand on the page of formats."""

_HEAD: Final = """\
# Keys of files

This page is written from the models that read these files. An unknown key is refused, with its place.
[The page of formats](../formats.md) explains each kind of file, and lists the keys of plants.
"""
_TOLD: Final = re.compile(r"^ +([\w, ]+): (.+(?:\n {6,}.+)*)", re.MULTILINE)


def page() -> str:
    """The text of the page: a table of keys for each part of each kind of file."""
    lines = [_HEAD]
    for title, models in FILES.items():
        lines.append(f"## {title}\n")
        parts: dict[str, Any] = {}
        for model in models:
            schema = model.model_json_schema()
            parts |= {model.__name__: schema, **schema.pop("$defs", {})}
        for name, part in parts.items():
            lines += _section(name, part, parts)
    return "\n".join(lines)


def _section(name: str, part: dict[str, Any], parts: dict[str, Any]) -> Iterator[str]:
    """A part's table; parts without keys are told where they are used."""
    if not part.get("properties"):
        return
    text = part.get("description", "")
    told = {key.strip(): meaning for keys, meaning in _TOLD.findall(text) for key in keys.split(",")}
    yield f"### {name}\n\n{' '.join(text.partition('Attributes:')[0].split())}\n"
    heads = ("key", "value", "without it", *(("meaning",) if told else ()))
    yield f"| {' | '.join(heads)} |\n|{' --- |' * len(heads)}"
    for key, field in part["properties"].items():
        cells = (f"`{key}`", _value(field, parts), _usual(key, field, part), told.get(key, ""))
        yield f"| {' | '.join(' '.join(cell.split()).replace('|', '/') for cell in cells[: len(heads)])} |"
    yield ""


def _usual(key: str, field: dict[str, Any], part: dict[str, Any]) -> str:
    if key in part.get("required", ()):
        return "refused"
    usual = field.get("default")
    return "the values of its own table" if isinstance(usual, dict) and usual else f"`{json.dumps(usual)}`"


def _value(field: dict[str, Any], parts: dict[str, Any]) -> str:
    """What a key takes, in words."""
    if "$ref" in field:
        name = field["$ref"].rpartition("/")[2]
        known = parts[name].get("properties")
        return f"[{name}](#{name.lower()})" if known else _value(parts[name], parts)
    if choices := field.get("anyOf") or field.get("oneOf"):
        return " or ".join(dict.fromkeys(_value(one, parts) for one in choices))
    if allowed := field.get("enum") or ([field["const"]] if "const" in field else []):
        return ", ".join(f"`{one}`" for one in allowed)
    if "prefixItems" in field:
        return f"`[…]` with {', '.join(_value(one, parts) for one in field['prefixItems'])}"
    if field.get("type") == "array":
        return f"list of {_value(field.get('items', {}), parts)}"
    if isinstance(held := field.get("additionalProperties"), dict):
        return f"keys, each {_value(held, parts)}"
    return " ".join([_KINDS.get(field.get("type", ""), "any value"), *_bounds(field)])


_KINDS: Final = {
    "number": "number",
    "integer": "whole number",
    "string": "text",
    "boolean": "`true` or `false`",
    "null": "`null`",
    "object": "keys",
}
_BOUNDS: Final = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}


def _bounds(field: dict[str, Any]) -> Iterator[str]:
    return (f"{sign} {field[bound]:g}" for bound, sign in _BOUNDS.items() if bound in field)
