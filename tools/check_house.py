"""What `make check` asks of the house beyond what linters know; one line for each finding."""

from __future__ import annotations

import ast
import graphlib
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import grimp
from house_names import names
from house_pages import pages
from house_words import words

ROOT = Path(__file__).parents[1]

LONGEST_FILE = 450
LONGEST_FUNCTION = 60

_PRODUCT = ("nxt_twin", "firmware_protocol")
_MAY_PRINT = ("nxt_twin/cli/", "firmware_protocol/__main__.py")
_USER_PATH = re.compile(r"(?<![\w.])(?:/(?:root|work|home/[\w.-]+)/|[A-Za-z]:\\{1,2}Users)")
_CHECKS = re.compile(r"assert|^check|raises$|fail$")


def main() -> int:
    """Print every finding; 1 if there is one."""
    found = [
        *_product(),
        *_circles(),
        *_locks(),
        *_user_paths(),
        *_tests(),
        *names(ROOT),
        *pages(ROOT),
        *words(ROOT),
    ]
    print(*found, sep="\n", end="\n" if found else "")
    return 1 if found else 0


def _product() -> Iterator[str]:
    """Files and functions that are too long, and prints where nothing is to be printed."""
    for path in (path for package in _PRODUCT for path in sorted((ROOT / package).rglob("*.py"))):
        place = _place(path)
        text = path.read_text(encoding="utf-8")
        if (lines := len(text.splitlines())) > LONGEST_FILE:
            yield f"{place}: {lines} lines, more than {LONGEST_FILE}"
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                lines = (node.end_lineno or node.lineno) - node.lineno + 1
                if lines > LONGEST_FUNCTION:
                    yield f"{place}:{node.lineno}: {node.name} has {lines} lines, more than {LONGEST_FUNCTION}"
            if _called(node) == "print" and not place.startswith(_MAY_PRINT):
                yield f"{place}:{node.lineno}: print outside the command line"  # type: ignore[attr-defined]


def _circles() -> Iterator[str]:
    """One ring of files that import one another, for types only or not."""
    graph = grimp.build_graph(*_PRODUCT)
    imports = {file: graph.find_modules_directly_imported_by(file) for file in graph.modules}
    try:
        graphlib.TopologicalSorter(imports).prepare()
    except graphlib.CycleError as error:
        yield f"a circle of imports: {' <- '.join(error.args[1])}"


def _locks() -> Iterator[str]:
    """Requirements that carry an address."""
    for path in sorted((ROOT / "requirements").iterdir()):
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if "://" in line:
                yield f"{_place(path)}:{number}: an address in a requirements file"


def _user_paths() -> Iterator[str]:
    """Tracked text files that name a folder of somebody's machine."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True, text=True)
    for path in (ROOT / name for name in listed.stdout.split("\0") if name):
        try:
            lines = path.read_text(encoding="utf-8").splitlines()
        except (UnicodeDecodeError, FileNotFoundError):
            continue
        for number, line in enumerate(lines, 1):
            if hit := _USER_PATH.search(line):
                yield f"{_place(path)}:{number}: names {hit.group()}, a path of one machine"


def _tests() -> Iterator[str]:
    """Test files in which nothing can fail."""
    for path in sorted((ROOT / "tests").rglob("test_*.py")):
        nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if not any(isinstance(node, ast.Assert) or _CHECKS.search(_called(node)) for node in nodes):
            yield f"{_place(path)}: asserts nothing"


def _called(node: ast.AST) -> str:
    """The last name of what `node` calls; empty if it is no call."""
    if not isinstance(node, ast.Call):
        return ""
    return getattr(node.func, "attr", "") or getattr(node.func, "id", "")


def _place(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


if __name__ == "__main__":
    sys.exit(main())
