"""The tool's own worlds and robots, by their names."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from nxt_twin.mock.errors import WorldError
from nxt_twin.recording.configs import configs_dir
from nxt_twin.recording.source import nearest_name, quoted

YAML: Final = (".yaml", ".yml")


def world_file(given: str | Path) -> Path:
    """A world's file by its path, or by the name of one of the tool's own worlds, such as `pen`.

    Raises:
        WorldError: it is no path, and no world has that name.
    """
    path = Path(given)
    return path if path.suffix or path.parent != Path() else named(given, "worlds")


def named(given: str | Path, folder: str, *, where: str = "") -> Path:
    """A file by its path, or by its name in one of the tool's own folders; `where` it was named, for errors.

    Raises:
        WorldError: there is none of that name.
    """
    path = Path(given)
    if path.suffix in YAML:
        return path
    known = {file.stem: file for file in sorted((configs_dir() / folder).glob("*.yaml"))}
    if str(given) not in known:
        mend = f"nearest known: {nearest_name(str(given), known)}; or name a .yaml file"
        raise WorldError(f"there is nothing named {quoted(str(given))} in {folder}", where=where, mend=mend)
    return known[str(given)]
