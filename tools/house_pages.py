"""What `make check` asks of pages: those that anything names exist, with the section that it names."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

_LINK = re.compile(r"(?<!!)\[[^\]]*\]\(([^)\s]+)\)|!\[[^\]]*\]\(([^)\s]+)\)")
_NAMED = re.compile(r"docs/[\w/-]+\.md(?:#[\w-]+)?")
_IN_HOUSE = re.compile(r"\bcontract \d", re.IGNORECASE)
_HEADING = re.compile(r"^#+ +(.*)$", re.MULTILINE)
_CODE = ("nxt_twin", "firmware_protocol", "benchmarks", "tests", "configs", "examples")


def pages(root: Path) -> Iterator[str]:
    """Links of pages, and pages named in code and help, that lead nowhere; and names that only insiders know."""
    for page in [*root.glob("*.md"), *sorted((root / "docs").rglob("*.md"))]:
        for number, line in _lines(page):
            for match in _LINK.finditer(line):
                target = match.group(1) or match.group(2)
                if not target.startswith(("http:", "https:", "mailto:")):
                    yield from _complaint(root, page, number, _resolved(page, target))
    for path in (path for folder in _CODE for path in sorted((root / folder).rglob("*"))):
        if path.suffix in (".py", ".yaml", ".html"):
            for number, line in _lines(path):
                for named in _NAMED.findall(line):
                    yield from _complaint(root, path, number, str(root / named))
                if _IN_HOUSE.search(line):
                    yield f"{path.relative_to(root)}:{number}: names a contract; name the page and its section"


def anchors(text: str) -> set[str]:
    """The sections of a page, as links name them."""
    bare = (re.sub(r"[^\w\- ]", "", heading.lower()) for heading in _HEADING.findall(text))
    return {heading.strip().replace(" ", "-") for heading in bare}


def _resolved(page: Path, target: str) -> str:
    path, hash_, section = target.partition("#")
    return f"{(page.parent / path).resolve() if path else page}{hash_}{section}"


def _complaint(root: Path, source: Path, number: int, target: str) -> Iterator[str]:
    name, _, section = target.partition("#")
    path, place = Path(name), f"{source.relative_to(root)}:{number}"
    if not path.exists():
        yield f"{place}: names {_short(root, path)}, which does not exist"
    elif section and section not in _anchors_of(path):
        yield f"{place}: names the section {section}, which {_short(root, path)} does not have"


def _short(root: Path, path: Path) -> str:
    return path.relative_to(root).as_posix() if path.is_relative_to(root) else str(path)


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    yield from enumerate(path.read_text(encoding="utf-8").splitlines(), 1)


@cache
def _anchors_of(path: Path) -> set[str]:
    return anchors(path.read_text(encoding="utf-8"))
