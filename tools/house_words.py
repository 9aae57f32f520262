"""What `make check` asks of words: docs/writing.md, on the pages that follow it already."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

MOST_WORDS: Final = 25

PAGES: Final = (
    "README.md", "CONTRIBUTING.md", "docs/api.md", "docs/dashboard.md", "docs/glossary.md", "docs/stability.md",
    "docs/decisions", "docs/connect.md", "docs/record.md", "docs/protocol.md", "docs/paper.md", "docs/testing.md",
    "docs/formats.md", "docs/robots.md", "docs/proof.md", "docs/world.md", "docs/sensors.md", "docs/mock.md",
    "docs/experiments.md", "docs/live.md", "docs/writing.md", "docs/export.md", "docs/reliability.md",
    "docs/diagnosis.md", "docs/fleet.md",
)  # fmt: skip
"""A page that is rewritten joins; a folder stands for its pages."""

_FORBIDDEN: Final = {
    r"\bfore(?:tell|tells|told)\b": "predict",
    r"\b(?:so many|so much|that much|as many) (?:again|seconds|s\b)": "the number",
    r"\bthe same(?=[.,;:)]|$)": "the noun",
    r"\bmade[- ]up\b": "synthetic",
    r"\brun-?outs?\b": "coast-down",
    r"(?:^|[.:;] )What (?:is|was|it|the|they|a|an)\b": "the thing's name as the subject",
}
_NO_PROSE: Final = re.compile(r"^(?: {4}|\||#|```|!\[|\s*$)")
_LINK: Final = re.compile(r"\[([^\]]*)\]\([^)]*\)")
_CODE: Final = re.compile(r"`[^`]*`")
_END: Final = re.compile(r"(?<=[.!?:;])\s+(?=[A-Z`*(\"])")


def words(root: Path) -> Iterator[str]:
    """Sentences that are too long, and words that another word is meant for, with place and mend."""
    for page in _pages(root):
        place = page.relative_to(root).as_posix()
        for number, paragraph in _paragraphs(page.read_text(encoding="utf-8")):
            for sentence in _END.split(paragraph):
                count = len(re.findall(r"[\w'’-]+", sentence))
                if count > MOST_WORDS:
                    yield f"{place}:{number}: a sentence of {count} words, more than {MOST_WORDS}: {sentence[:60]}…"
            for pattern, instead in _FORBIDDEN.items():
                if found := re.search(pattern, paragraph):
                    yield f"{place}:{number}: '{found.group().strip()}': write {instead}"


def _pages(root: Path) -> Iterator[Path]:
    for name in PAGES:
        path = root / name
        yield from sorted(path.glob("*.md")) if path.is_dir() else [path]


def _paragraphs(text: str) -> Iterator[tuple[int, str]]:
    """Prose with the number of its first line; each item of a list is a paragraph."""
    kept: list[str] = []
    began, fenced = 0, False
    for number, line in enumerate([*text.splitlines(), ""], 1):
        fenced ^= line.startswith("```")
        prose = not fenced and not _NO_PROSE.match(line)
        item = re.match(r"\s*(?:[-*]|\d+\.) ", line)
        if kept and (item or not prose):
            yield began, _plain(" ".join(kept))
            kept = []
        if prose:
            began = began if kept else number
            kept.append(line[item.end() :] if item else line)


def _plain(text: str) -> str:
    return _CODE.sub("`code`", _LINK.sub(r"\1", text)).replace("**", "")
