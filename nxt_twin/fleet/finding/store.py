"""Where a fleet's files lie: on this machine, or wherever fsspec reaches."""

from __future__ import annotations

import glob
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, final

from nxt_twin.fleet.errors import FleetError

_MAGIC = "*?["


@final
@dataclass(frozen=True)
class Root:
    """A folder or a file to look in.

    Attributes:
        path: as its store names it.
        base: the folder from which the names of units and sessions are taken.
    """

    path: str
    base: str


@final
@dataclass(frozen=True)
class Folder:
    """A folder with the names of its files, sorted."""

    path: str
    files: tuple[str, ...]


class Store(Protocol):
    """Files by their paths, with `/` between the parts."""

    def roots(self, text: str) -> list[Root]:
        """The paths behind a folder, a file or a glob; none where nothing is there."""

    def walk(self, path: str) -> Iterator[Folder]:
        """The folder and all below it, in the order of their names."""

    def is_file(self, path: str) -> bool:
        """Whether it is a file rather than a folder."""

    def read(self, path: str) -> bytes:
        """A file's content.

        Raises:
            OSError: it cannot be read.
        """

    def name(self, path: str) -> str:
        """What to call it for a person, who can use it again."""


def store_of(text: str) -> Store:
    """The store of a path or a URL.

    Raises:
        FleetError: it is a URL, and fsspec or what it needs for such URLs is not installed.
    """
    if "://" not in text:
        return Local()
    try:
        import fsspec

        return Remote(fsspec.core.url_to_fs(text)[0])
    except ImportError as error:
        mend = "pip install 'nxt-twin[fleet]', and what fsspec names for such URLs"
        raise FleetError(f"cannot be reached: {error}", where=text, mend=mend) from None
    except (ValueError, OSError) as error:
        raise FleetError(f"cannot be reached: {error}", where=text, mend="check the URL") from None


@final
class Local:
    """This machine's files."""

    def roots(self, text: str) -> list[Root]:
        """As `Store.roots`."""
        if not _is_magic(text):
            base = text if Path(text).is_dir() else str(Path(text).parent)
            return [Root(text, base)] if Path(text).exists() else []
        base = _before_magic(text)
        found = sorted(glob.glob(text, recursive=True))  # noqa: PTH207 - a Path's wants it relative
        return [Root(path, base) for path in found]

    def walk(self, path: str) -> Iterator[Folder]:
        """As `Store.walk`."""
        for folder, below, files in os.walk(path):
            below.sort()
            yield Folder(Path(folder).as_posix(), tuple(sorted(files)))

    def is_file(self, path: str) -> bool:
        """As `Store.is_file`."""
        return Path(path).is_file()

    def read(self, path: str) -> bytes:
        """As `Store.read`."""
        return Path(path).read_bytes()

    def name(self, path: str) -> str:
        """As `Store.name`."""
        return path


@final
class Remote:
    """The files of a file system of fsspec."""

    def __init__(self, system: Any) -> None:  # noqa: ANN401 - fsspec has no types
        self._system = system

    def roots(self, text: str) -> list[Root]:
        """As `Store.roots`."""
        path = str(self._system._strip_protocol(text))  # noqa: SLF001 - fsspec's own users call it
        if not _is_magic(path):
            there = self._system.exists(path)
            base = path.rpartition("/")[0] if there and self._system.isfile(path) else path
            return [Root(path, base)] if there else []
        return [Root(str(each), _before_magic(path)) for each in sorted(self._system.glob(path))]

    def walk(self, path: str) -> Iterator[Folder]:
        """As `Store.walk`."""
        for folder, below, files in self._system.walk(path):
            below.sort()
            yield Folder(str(folder), tuple(sorted(files)))

    def is_file(self, path: str) -> bool:
        """As `Store.is_file`."""
        return bool(self._system.isfile(path))

    def read(self, path: str) -> bytes:
        """As `Store.read`."""
        return bytes(self._system.cat_file(path))

    def name(self, path: str) -> str:
        """As `Store.name`."""
        return str(self._system.unstrip_protocol(path))


def _is_magic(text: str) -> bool:
    return any(sign in text for sign in _MAGIC)


def _before_magic(text: str) -> str:
    """The folder before the first part of a path that holds a wildcard."""
    parts = text.split("/")
    first = next(number for number, part in enumerate(parts) if _is_magic(part))
    return "/".join(parts[:first]) or ("/" if text.startswith("/") else ".")
