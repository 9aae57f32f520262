"""What `make check` asks of words: docs/writing.md, on pages, templates, docstrings and spoken sentences."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from house_code import docstrings, spoken
from house_markup import templates

MOST_WORDS: Final = 25

PAGES: Final = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs", "examples")
"""A folder stands for every page below it."""

_FORBIDDEN: Final = {
    r"\bfore(?:tell|tells|told)\b": "predict",
    r"\b(?:so many|so much|that much)\b": "the number or the quantity",
    r"\bthe same(?=[.,;:)]|$)": "the noun",
    r"\bmade[- ]up\b": "synthetic",
    r"\brun-?outs?\b": "coast-down",
    r"(?:^|[.:;] )What (?:is|was|it|the|they|a|an)\b": "the thing's name as the subject",
}
_NO_PROSE: Final = re.compile(r"^(?: {4}|\||#|```|!\[|\s*$)")
_LINK: Final = re.compile(r"\[([^\]]*)\]\([^)]*\)")
_CODE: Final = re.compile(r"`+[^`]*`+")
_END: Final = re.compile(r"(?<=[.!?:;])\s+(?=[A-Z`*(\"])")


def words(root: Path) -> Iterator[str]:
    """Sentences that are too long, and words that another word is meant for, with place and mend."""
    for place, paragraph in (*_of_pages(root), *docstrings(root), *spoken(root), *templates(root)):
        yield from (f"{place}: {fault}" for fault in faults(paragraph))


def faults(paragraph: str) -> Iterator[str]:
    """Each fault of a paragraph, with its mend."""
    plain = _plain(paragraph)
    for sentence in _END.split(plain):
        count = len(re.findall(r"[\w'’-]+", sentence))
        if count > MOST_WORDS:
            yield f"a sentence of {count} words, more than {MOST_WORDS}: {sentence}"
    for pattern, instead in _FORBIDDEN.items():
        if found := re.search(pattern, plain):
            yield f"'{found.group().strip()}': write {instead}"


def _of_pages(root: Path) -> Iterator[tuple[str, str]]:
    for name in PAGES:
        path = root / name
        for page in sorted(path.rglob("*.md")) if path.is_dir() else [path]:
            place = page.relative_to(root).as_posix()
            for number, paragraph in _paragraphs(page.read_text(encoding="utf-8")):
                yield f"{place}:{number}", paragraph


def _paragraphs(text: str) -> Iterator[tuple[int, str]]:
    """Prose with the number of its first line; each item of a list is a paragraph."""
    kept: list[str] = []
    began, fenced = 0, False
    for number, line in enumerate([*text.splitlines(), ""], 1):
        fenced ^= line.startswith("```")
        prose = not fenced and not _NO_PROSE.match(line)
        item = re.match(r"\s*(?:[-*]|\d+\.) ", line)
        if kept and (item or not prose):
            yield began, " ".join(kept)
            kept = []
        if prose:
            began = began if kept else number
            kept.append(line[item.end() :] if item else line)


def _plain(text: str) -> str:
    return _CODE.sub("`code`", _LINK.sub(r"\1", text)).replace("**", "")
