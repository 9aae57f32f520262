"""A hook of mkdocs: pages that no file in docs/ holds, and links that leave docs/.

The start page is the README. Commands and docstrings get pages of their own, which are written while the site is built.
"""

from __future__ import annotations

import posixpath
import re
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

sys.path.insert(0, str(Path(__file__).parent))

import cli_page
import keys_page
import library_page

ROOT: Final = Path(__file__).parents[1]

COPIED: Final[Mapping[str, str]] = {
    "index.md": "README.md",
    "changelog.md": "CHANGELOG.md",
    "contributing.md": "CONTRIBUTING.md",
    "examples/ci.md": "examples/ci/README.md",
    "examples/user_effect.md": "examples/user_effect/README.md",
    "examples/first_diagnosis.ipynb": "examples/first_diagnosis.ipynb",
}
"""Pages and files of the site whose text stands elsewhere in the project."""

WRITTEN: Final[Mapping[str, Callable[[], str]]] = {
    "reference/commands.md": cli_page.page,
    "reference/keys.md": keys_page.page,
    "reference/library.md": library_page.library,
    "reference/firmware_protocol.md": library_page.protocol,
}
"""Pages that are written from the code."""

_CELL: Final = re.compile(r"<td.*?</td>", re.DOTALL)
_CODE: Final = re.compile(r"(?<=<code>)[^<]+(?=</code>)")
_JOINT: Final = re.compile(r"(?<=\w)([_/])(?=\w)")
"""Where a long name may continue on the next line: after an underscore or a slash."""

_LINK: Final = re.compile(r"(!?\[[^\]]*\]\()([^)\s#]+)((?:#[\w-]*)?\))")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that no file in docs/ holds."""
    for name, source in COPIED.items():
        files.append(File.generated(config, name, abs_src_path=str(ROOT / source)))
    for name, write in WRITTEN.items():
        files.append(File.generated(config, name, content=write()))
    return files


def on_page_markdown(markdown: str, page: Page, **_: object) -> str:
    """Make the links of a page lead where the site keeps what they name."""
    name = page.file.src_uri
    if name in WRITTEN:
        return markdown
    source = COPIED.get(name, f"docs/{name}")
    return "\n".join(_led(markdown.splitlines(), name, source))


def on_post_page(output: str, **_: object) -> str:
    """Let the names in tables break where a reader parts them, so that no phone breaks them within a word."""
    return _CELL.sub(lambda cell: _CODE.sub(lambda code: _JOINT.sub(r"\1<wbr>", code[0]), cell[0]), output)


def placed(source: str, target: str) -> str | None:
    """Where the site keeps the file that a page of the project names; None if it does not keep it.

    Args:
        source: Path of the page in the project, such as ``docs/api.md``.
        target: The link's path, relative to the page.
    """
    meant = posixpath.normpath(posixpath.join(posixpath.dirname(source), target))
    for name, kept in COPIED.items():
        if meant in (kept, posixpath.dirname(kept) or "."):
            return name
    return meant.removeprefix("docs/") if meant.startswith("docs/") else None


def _led(lines: list[str], name: str, source: str) -> list[str]:
    def led(match: re.Match[str]) -> str:
        before, target, after = match.groups()
        if ":" in target:
            return match.group()
        kept = placed(source, target)
        if kept is None:
            return (
                before.lstrip("!").lstrip("[").removesuffix("](")
            )  # the site has no such page: the words stay
        return f"{before}{posixpath.relpath(kept, posixpath.dirname(name) or '.')}{after}"

    return [line if line.startswith("    ") else _LINK.sub(led, line) for line in lines]
