"""Which mapping a recording of a case is read through: one for all, or one by file or pattern.

The models of mappings take a thirtieth of a second to build. They are imported where a mapping is read, as most
recordings have none.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nxt_twin.errors import CaseError, MappingError
from nxt_twin.recording.robot_keys import is_robots
from nxt_twin.recording.source import quoted
from nxt_twin.recording.yaml_file import read_yaml

if TYPE_CHECKING:
    from nxt_twin.recording.any_mapping import AnyMapping

MappingOf = Callable[[str], "AnyMapping | None"]
"""Gives the mapping of a recording by its name; None for a brick's."""

GivenMapping = str | dict[str, Any] | None
"""What `mapping:` may be: a file, a mapping's own keys, or either by file or pattern."""


def no_mapping(_name: str) -> None:
    """Every recording is a brick's."""


def one_mapping(mapping: AnyMapping) -> MappingOf:
    """Every recording is read through `mapping`."""
    return lambda _name: mapping


def mappings(given: GivenMapping, folder: Path, where: str) -> MappingOf:
    """The mappings that a case or a sidecar states.

    Args:
        given: what stands under `mapping:`.
        folder: from which files are named.
        where: it stands, for refusals.

    Raises:
        MappingError: one of them cannot be read.
        CaseError: it is neither a file nor keys.
    """
    if given is None:
        return no_mapping
    if isinstance(given, str) or _is_mapping(given):
        return one_mapping(_read(given, folder, where))
    known = {pattern: _read(each, folder, f"{where}, {pattern}") for pattern, each in given.items()}
    return lambda name: _matching(known, name, where)


def _matching(known: Mapping[str, AnyMapping], name: str, where: str) -> AnyMapping:
    """The mapping of the file itself, else of the first pattern that fits."""
    file = name.partition("#")[0]
    if file in known:
        return known[file]
    for pattern, mapping in known.items():
        if fnmatchcase(file, pattern) or fnmatchcase(Path(file).name, pattern):
            return mapping
    raise MappingError(f"names no mapping for {file}", where=where, mend=f"write `{file}: MAPPING.yaml`")


def read_mappings(path: Path) -> MappingOf:
    """A mapping file, which may also hold several mappings by file or pattern.

    Raises:
        MappingError, CaseError: as `mappings`.
    """
    from nxt_twin.recording.any_mapping import read_any_mapping

    keys = read_yaml(path, MappingError)
    if not keys or _is_mapping(keys):
        return one_mapping(read_any_mapping(path))
    return mappings(keys, path.parent, str(path))


def given_in_sidecar(sidecar: Mapping[str, Any]) -> GivenMapping:
    """The mapping that a sidecar names under `mapping`, or whose keys it holds, as `map --out` writes them."""
    if not sidecar:
        return None
    if "mapping" in sidecar or not _is_mapping(sidecar):
        return sidecar.get("mapping")
    from nxt_twin.recording.any_mapping import MAPPING_KEYS

    return {key: value for key, value in sidecar.items() if key in MAPPING_KEYS}


def _is_mapping(given: Mapping[str, Any]) -> bool:
    return not given.keys().isdisjoint(("time", "input", "output")) or is_robots(given)


def _read(given: object, folder: Path, where: str) -> AnyMapping:
    from nxt_twin.recording.any_mapping import any_mapping_of, read_any_mapping

    if isinstance(given, str):
        return read_any_mapping(folder / given)
    if isinstance(given, dict):
        return any_mapping_of(given, where)
    raise CaseError(f"{quoted(given)} is no mapping", where=where, mend="name a file, or write its keys")
