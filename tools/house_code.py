"""The prose in code: public docstrings, and sentences that a person reads on the terminal or in a report."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

ROOMS: Final = ("nxt_twin", "firmware_protocol", "benchmarks", "tools", "examples")
"""Each public docstring in these folders follows docs/writing.md."""

SPEAKERS: Final = ("nxt_twin", "firmware_protocol")
"""Each string in these folders is a sentence, or a part of one, that a person reads; code and markup are left out."""

_MARKUP: Final = re.compile(r"[\n<]")
_SECTION: Final = re.compile(r"^\s*(?:Args|Attributes|Raises|Returns|Yields):\s*")
_ENTRY: Final = re.compile(r"^\s+\*{0,2}[\w.]+(?:, [\w.]+)*: ")
_CODE: Final = re.compile(r"\s*(?:>>>|\.\.\. |[─│├└]| +\S* = )")
_Public = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef


def docstrings(root: Path) -> Iterator[tuple[str, str]]:
    """The paragraphs of public docstrings, each with its place; an argument's line is a paragraph."""
    for path, place in _files(root, ROOMS):
        for node in _public(ast.parse(path.read_text(encoding="utf-8"))):
            text = ast.get_docstring(node, clean=False) or ""
            for paragraph in _paragraphs(text):
                yield f"{place}:{getattr(node, 'lineno', 1)}", paragraph


def spoken(root: Path) -> Iterator[tuple[str, str]]:
    """The strings that a person reads, each with its place; a value that is filled in counts as one word."""
    for path, place in _files(root, SPEAKERS):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        inner = {
            id(part) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for part in ast.walk(node)
        }
        docs = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)} | _equations(tree)
        for node in ast.walk(tree):
            if id(node) in docs or not isinstance(node, ast.Constant | ast.JoinedStr):
                continue
            whole = isinstance(node, ast.JoinedStr) or id(node) not in inner
            if whole and not _MARKUP.search(text := _text(node)):
                yield f"{place}:{node.lineno}", text


def _equations(tree: ast.Module) -> set[int]:
    """The strings of `equation=`, which are formulas."""
    named = (
        node.value for node in ast.walk(tree) if isinstance(node, ast.keyword) and node.arg == "equation"
    )
    return {id(node) for node in named}


def _text(node: ast.Constant | ast.JoinedStr) -> str:
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    return "".join(str(part.value) if isinstance(part, ast.Constant) else "x" for part in node.values)


def _files(root: Path, names: tuple[str, ...]) -> Iterator[tuple[Path, str]]:
    for name in names:
        path = root / name
        for file in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            yield file, file.relative_to(root).as_posix()


def _public(node: _Public) -> Iterator[_Public]:
    """A module, its public classes and functions, and theirs."""
    yield node
    for child in node.body:
        if isinstance(child, _Public) and not child.name.startswith("_"):
            yield from _public(child)


def _paragraphs(text: str) -> Iterator[str]:
    kept: list[str] = []
    for line in [*text.splitlines(), ""]:
        code = _CODE.match(line)
        if kept and (not line.strip() or _SECTION.match(line) or _ENTRY.match(line)):
            yield " ".join(kept)
            kept = []
        if line.strip() and not _SECTION.match(line) and not code:
            kept.append(_ENTRY.sub("", line).strip())
