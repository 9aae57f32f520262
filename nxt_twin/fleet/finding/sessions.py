"""The sessions below folders, each of which is one case."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path, PurePosixPath
from typing import Any, Final, final

from nxt_twin.fleet.errors import FleetError
from nxt_twin.fleet.finding.fleet_file import FLEET_FILE, FleetFile, read_fleet_file
from nxt_twin.fleet.finding.labels import Labels, is_session, labels_of
from nxt_twin.fleet.finding.store import Folder, Root, Store, store_of

CASE_FILE: Final = "case.yaml"
_TABLES: Final = (".csv", ".parquet")
_MAPPED: Final = (*_TABLES, ".mat", ".txt", ".tsv", ".feather", ".arrow", ".json", ".jsonl", ".mcap")
_YAML: Final = (".yaml", ".yml")


@final
@dataclass(frozen=True)
class LoggedSession:
    """One case: a unit's recordings of one occasion.

    Attributes:
        labels: whose they are.
        store: where they lie.
        source: the folder or file, as a person names it.
        files: paths of all files that belong to it, by their names within the case.
        recordings: the names of the tables; none for a case folder, whose `case.yaml` lists them.
        keys: what the fleet's file says of all its cases.
    """

    labels: Labels
    store: Store
    source: str
    files: dict[str, str]
    recordings: tuple[str, ...]
    keys: dict[str, Any]


def sessions(places: Sequence[str]) -> Iterator[LoggedSession]:
    """Each session in the order of its place, folder and name.

    Args:
        places: folders, files, globs, or URLs of either.

    Raises:
        FleetError: there is nothing at a place, it cannot be reached, or its `fleet.yaml` is wrong.
    """
    for place in places:
        store = store_of(place)
        roots = store.roots(place)
        if not roots:
            raise FleetError(
                "there is no such file or folder", where=place, mend="name what holds the recordings"
            )
        file = read_fleet_file(store, roots[0].base)
        for root in roots:
            yield from _below(_Tree(store, root.base, file), root)


def session_count(places: Sequence[str]) -> int:
    """How many sessions there are, after a check that no two have one name.

    Raises:
        FleetError: as `sessions`; there is none; two belong to one unit and session.
    """
    seen: set[bytes] = set()
    for session in sessions(places):
        name = identity(session.labels)
        if name in seen:
            what = f"is not the only session {session.labels.session!r} of unit {session.labels.unit!r}"
            mend = "name folders apart, as in unit=7/session=2, or list `folders:` in fleet.yaml"
            raise FleetError(what, where=session.source, mend=mend)
        seen.add(name)
    if not seen:
        mend = "a fleet is folders UNIT/SESSION of .csv or .parquet files, or of cases"
        raise FleetError("holds no recordings", where=", ".join(places), mend=mend)
    return len(seen)


def identity(labels: Labels) -> bytes:
    """Eight bytes that stand for a unit's session: a million of them fit into memory."""
    return blake2b(f"{labels.unit}\0{labels.session}".encode(), digest_size=8).digest()


@final
@dataclass(frozen=True)
class _Tree:
    """A store with the folder that names are taken from, and what its file says."""

    store: Store
    base: str
    file: FleetFile

    def parts(self, folder: str) -> tuple[str, ...]:
        """The parts of a folder's path below the base; the base's own name where there are none."""
        path = PurePosixPath(folder)
        below = path.relative_to(self.base).parts if path.is_relative_to(self.base) else path.parts
        return tuple(part for part in below if part != ".")

    def session(
        self, labels: Labels, folder: Folder, files: dict[str, str], tables: Sequence[str]
    ) -> LoggedSession:
        """A session; of a single table the source is that table."""
        source = files[tables[0]] if len(tables) == 1 else folder.path
        keys = self.file.case_keys() if tables else {}
        return LoggedSession(labels, self.store, self.store.name(source), files, tuple(tables), keys)


def _below(tree: _Tree, root: Root) -> Iterator[LoggedSession]:
    if tree.store.is_file(root.path):
        path = PurePosixPath(root.path)
        tables = [path.name] if _is_table(path.name, mapped=tree.file.mapping is not None) else []
        yield from _single(tree, next(tree.store.walk(str(path.parent))), tables)
        return
    case = ""
    for folder in tree.store.walk(root.path):
        if case and PurePosixPath(folder.path).is_relative_to(case):
            continue  # part of that case
        if CASE_FILE in folder.files:
            case = folder.path
            yield _case(tree, folder)
        else:
            yield from _tables(tree, folder)


def _case(tree: _Tree, top: Folder) -> LoggedSession:
    files = {
        str(PurePosixPath(folder.path, name).relative_to(top.path)): str(PurePosixPath(folder.path, name))
        for folder in tree.store.walk(top.path)
        for name in folder.files
    }
    parts = tree.parts(top.path) or (_own_name(top.path),)
    return tree.session(labels_of(parts, tree.file.folders), top, files, ())


def _own_name(path: str) -> str:
    """The name of a case folder that was named itself."""
    return PurePosixPath(path).name or Path.cwd().name


def _tables(tree: _Tree, folder: Folder) -> Iterator[LoggedSession]:
    """The sessions of a folder's tables: one of them all, or one of each."""
    tables = [name for name in folder.files if _is_table(name, mapped=tree.file.mapping is not None)]
    parts = tree.parts(folder.path)
    if not is_session(parts, tree.file.folders):
        yield from _single(tree, folder, tables)
    elif tables:
        files = {
            name: f"{folder.path}/{name}" for name in folder.files if name in tables or name.endswith(_YAML)
        }
        yield tree.session(labels_of(parts, tree.file.folders), folder, files, tables)


def _single(tree: _Tree, folder: Folder, tables: Sequence[str]) -> Iterator[LoggedSession]:
    """Each table as a session, with its sidecar and the files that sidecars name."""
    stems = {PurePosixPath(name).stem for name in folder.files if not name.endswith(_YAML)}
    shared = [
        name
        for name in folder.files
        if name.endswith(_YAML) and name != FLEET_FILE and PurePosixPath(name).stem not in stems
    ]
    for table in tables:
        stem = PurePosixPath(table).stem
        own = [table, *(f"{stem}{ending}" for ending in _YAML if f"{stem}{ending}" in folder.files), *shared]
        files = {name: f"{folder.path}/{name}" for name in own}
        yield tree.session(
            labels_of(tree.parts(folder.path), tree.file.folders, stem), folder, files, [table]
        )


def _is_table(name: str, *, mapped: bool) -> bool:
    return name.lower().endswith(_MAPPED if mapped else _TABLES) and not name.startswith((".", "_"))
