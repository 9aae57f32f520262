"""Check a built site: a page that makes a browser ask another machine for something is named."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Final

_LOADS: Final = {
    "script": "src", "img": "src", "iframe": "src", "link": "href", "source": "src", "video": "src", "audio": "src",
    "embed": "src", "object": "data", "input": "src", "use": "href",
}  # fmt: skip
_ELSEWHERE: Final = re.compile(r"^(?:[a-z]+:)?//", re.IGNORECASE)
_STYLE: Final = re.compile(r"(?:@import\s+|url\()\s*['\"]?((?:https?:)?//[^'\")\s]+)")
_NO_ASSET: Final = {"canonical", "prev", "next", "alternate", "edit"}


def main() -> int:
    """Print every finding for the folder that is named; 1 if there is one."""
    folder = Path(sys.argv[1])
    found = list(asked_elsewhere(folder))
    print(*found, sep="\n", end="\n" if found else "")
    if not found:
        print(
            f"{sum(1 for _ in folder.rglob('*.html'))} pages in {folder}; none asks another machine for anything"
        )
    return 1 if found else 0


def asked_elsewhere(folder: Path) -> Iterator[str]:
    """Scripts, styles, fonts, pictures and frames of a site's pages that stand on another machine, with place."""
    for page in sorted(folder.rglob("*.html")):
        reader = _Loads()
        reader.feed(page.read_text(encoding="utf-8"))
        yield from (f"{page.relative_to(folder)}: loads {address}" for address in reader.found)
    for style in sorted(folder.rglob("*.css")):
        for address in _STYLE.findall(style.read_text(encoding="utf-8")):
            yield f"{style.relative_to(folder)}: loads {address}"


class _Loads(HTMLParser):
    """Collects the addresses elsewhere that a browser loads by itself; a link that a reader may follow is none."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note what a tag loads."""
        given = dict(attrs)
        if tag == "link" and given.get("rel") in _NO_ASSET:
            return
        address = given.get(_LOADS.get(tag, "")) or ""
        if _ELSEWHERE.match(address):
            self.found.append(address)
        self.found.extend(_STYLE.findall(given.get("style") or ""))

    def handle_data(self, data: str) -> None:
        """Note what a style within the page loads."""
        self.found.extend(_STYLE.findall(data) if self.get_starttag_text() == "<style>" else [])


if __name__ == "__main__":
    sys.exit(main())
