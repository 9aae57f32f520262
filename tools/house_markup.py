"""The prose in HTML templates: each element's text, with the longest branch of what depends on a value."""

from __future__ import annotations

import html
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

_SILENT: Final = re.compile(r"<(style|script|svg)\b.*?</\1>|<!--.*?-->|\{#.*?#\}", re.DOTALL)
_BLOCK: Final = re.compile(
    r"</?(?:p|li|ul|ol|h\d|t[dhr]|thead|tbody|table|div|section|article|figure|figcaption|summary|details|"
    r"dt|dd|dl|header|footer|nav|main|body|head|html|title|caption|label|button|option|select|br|hr)\b"
    r"(?:\{%.*?%\}|\{\{.*?\}\}|[^>])*>"
)
_CHOICE: Final = re.compile(
    r"\{%-?\s*if\b(?:(?!%\}).)*%\}((?:(?!\{%-?\s*(?:if|endif)\b).)*)\{%-?\s*endif\s*-?%\}", re.DOTALL
)
_BRANCH: Final = re.compile(r"\{%-?\s*(?:else|elif\b(?:(?!%\}).)*)\s*-?%\}")
_CODE: Final = re.compile(r"<code>.*?</code>", re.DOTALL)
_VALUE: Final = re.compile(r"\{\{.*?\}\}", re.DOTALL)
_MARK: Final = re.compile(r"\{%.*?%\}|<[^>]*>", re.DOTALL)
_WORD: Final = re.compile(r"\w")


def templates(root: Path) -> Iterator[tuple[str, str]]:
    """The paragraphs of every page's template, each with its place; a value that is filled in counts as one word."""
    for path in sorted([*root.glob("nxt_twin/**/*.j2"), *root.glob("nxt_twin/**/*.html")]):
        place = path.relative_to(root).as_posix()
        for number, paragraph in paragraphs(path.read_text(encoding="utf-8")):
            yield f"{place}:{number}", paragraph


def paragraphs(text: str) -> Iterator[tuple[int, str]]:
    """The text of each block element, with the number of the line on which it begins."""
    text = _SILENT.sub(_lines_alone, text)
    begun = 0
    for block in [*_BLOCK.finditer(text), None]:
        inside = text[begun : block.start() if block else len(text)]
        if _WORD.search(plain := " ".join(_plain(inside).split())):
            yield text.count("\n", 0, begun + len(inside) - len(inside.lstrip())) + 1, plain
        begun = block.end() if block else begun


def _plain(text: str) -> str:
    chosen = ""
    while chosen != text:
        chosen, text = text, _CHOICE.sub(_longest_branch, text)
    text = _VALUE.sub("x", _CODE.sub("`code`", _BRANCH.sub(". ", text)))
    return html.unescape(_MARK.sub(" ", text))


def _longest_branch(choice: re.Match[str]) -> str:
    return max(_BRANCH.split(choice.group(1)), key=len)


def _lines_alone(silent: re.Match[str]) -> str:
    """Blank lines in place of what nobody reads, so that the numbers of lines stay."""
    return "\n" * silent.group().count("\n")
