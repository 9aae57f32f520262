"""The place in a YAML file of which an error message speaks: file, line and key."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import final

import yaml

from nxt_twin.recording.bounded_yaml import LOADER


@final
@dataclass(frozen=True)
class YamlPlace:
    """A file, or a part of it.

    Attributes:
        file: the file, which has been read as YAML before.
        under: the keys down to the part; empty for the whole file.
    """

    file: Path
    under: tuple[str, ...] = ()

    def of(self, keys: tuple[str, ...]) -> str:
        """The place of some key of the part in words; a key that is missing has the line of what it is missing in."""
        line = _line(self.file, (*self.under, *keys))
        parts = [str(self.file), f"line {line}" if line else "", ".".join(self.under)]
        parts.append(f"key {'.'.join(keys)}" if keys else "")
        return ", ".join(part for part in parts if part)


def _line(file: Path, keys: tuple[str, ...]) -> int:
    """The line of the deepest of nested keys that the file holds, from 1; 0 if it holds not even the first."""
    if not file.is_file():  # what is said of no file, as of a mock's own world
        return 0
    try:
        node, line = yaml.compose(file.read_text(encoding="utf-8-sig"), Loader=LOADER), 0
    except yaml.YAMLError:  # the file has become another since it was read
        return 0
    for key in keys:
        found = _below(node, key)
        if found is None:
            break
        node, mark = found
        line = mark.line + 1
    return line


def _below(node: yaml.Node | None, key: str) -> tuple[yaml.Node, yaml.Mark] | None:
    """The value at a key or index of a node, and where that key or item stands."""
    if isinstance(node, yaml.MappingNode):
        pairs = ((value, name.start_mark) for name, value in node.value if name.value == key)
        return next(pairs, None)
    if isinstance(node, yaml.SequenceNode) and key.isdigit() and int(key) < len(node.value):
        item = node.value[int(key)]
        return item, item.start_mark
    return None
