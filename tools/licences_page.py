"""Write docs/licences.md: what the wheel holds, and the licences of the packages that an installation brings."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

import closures

PAGE: Final = Path(__file__).parents[1] / "docs" / "licences.md"

_HEAD: Final = """\
# Licences

This page is written by `make licences` from the metadata of the installed packages.

The wheel holds only code and configuration of nxt-twin, under the [MIT licence](../LICENSE).
It holds no file of another project. The tests use nxt-python (GPL) as an independent client.
nxt-twin neither ships nor imports it.

Installing nxt-twin brings these packages from the package index, each under its own licence:

| package | licence | brought by |
| --- | --- | --- |"""


def main() -> None:
    """Write the page."""
    PAGE.write_text(page(), encoding="utf-8")
    print(PAGE.name)


def page() -> str:
    """The text of the page."""
    return "\n".join([_HEAD, *_rows(), ""])


def _rows() -> Iterator[str]:
    core = closures.brought()
    by_extra = {extra: closures.brought(extra) for extra in closures.EXTRAS}
    every = {name: held for packages in (core, *by_extra.values()) for name, held in packages.items()}
    for name, held in sorted(every.items()):
        extras = [f"`{extra}`" for extra, packages in by_extra.items() if name in packages]
        yield f"| {name} | {closures.licence(held)} | {'the core' if name in core else ', '.join(extras)} |"


if __name__ == "__main__":
    main()
