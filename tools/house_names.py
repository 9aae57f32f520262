"""What `make check` asks of names: one class, and one function among the rooms, bears a name."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Final

MEANT: Final[Mapping[str, str]] = MappingProxyType(
    {
        "bristle_torque": "the truth simulator writes its own physics, under the field's name",
        "current_after": "the truth simulator writes its own physics, under the field's name",
        "fit": "each sensor fits its own parameters, and the engine those of a motor",
        "main": "a program's entry",
        "to_json": "each answer as JSON",
    }
)
"""Names that functions of several rooms bear, and why a reader is not misled."""

_PACKAGES: Final = ("nxt_twin", "firmware_protocol")
_FRONTS: Final = ("api", "cli")
"""A function of the public face, or a verb, has the name of the function that it calls."""


def names(root: Path) -> Iterator[str]:
    """Names that two classes bear, or functions of two rooms; and entries of `MEANT` that nothing needs."""
    yield from _classes(root)
    first: dict[str, tuple[str, str]] = {}
    shared = set()
    for room, name, place in _functions(root):
        known, where = first.setdefault(name, (room, place))
        if known == room:
            continue
        shared.add(name)
        if name not in MEANT:
            yield f"{place}: {name} is a function of another room already, in {where}"
    for name in MEANT.keys() - shared:
        yield f"tools/house_names.py: no two rooms have a function {name}; take it out of MEANT"


def _classes(root: Path) -> Iterator[str]:
    first: dict[str, str] = {}
    for path in (path for package in _PACKAGES for path in sorted((root / package).rglob("*.py"))):
        for node in _tree(path).body:
            if isinstance(node, ast.ClassDef):
                place = f"{path.relative_to(root).as_posix()}:{node.lineno}"
                if node.name in first:
                    yield f"{place}: class {node.name} is defined in {first[node.name]} already"
                first.setdefault(node.name, place)


def _functions(root: Path) -> Iterator[tuple[str, str, str]]:
    """Each public function of a file: its room, its name and its place."""
    for package in _PACKAGES:
        for path in sorted((root / package).rglob("*.py")):
            inside = path.relative_to(root / package)
            room = inside.parts[0].removesuffix(".py") if package == "nxt_twin" else package
            for node in _tree(path).body:
                if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and _counts(room, inside, node):
                    yield room, node.name, f"{path.relative_to(root).as_posix()}:{node.lineno}"


def _counts(room: str, inside: Path, node: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    """Whether a function is public and neither of the public face nor a verb."""
    is_verb = room in _FRONTS and (room == "api" or node.name == inside.stem or bool(node.decorator_list))
    return not node.name.startswith("_") and not is_verb


def _tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))
