"""A case: the baseline plant, the recordings to fit, and those held out (docs/formats.md#cases)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from posixpath import normpath
from typing import TYPE_CHECKING, Any, final

import numpy as np
from pydantic import BaseModel, ConfigDict

from nxt_twin.errors import CaseError
from nxt_twin.recording.columns import PORTS, POSE_X, Port, goal_column, power_column, tacho_column
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.files import read_recording, read_sidecar
from nxt_twin.recording.guess.data_set import mapping_of_part, part_of, plant_of_part
from nxt_twin.recording.mappings import (
    GivenMapping,
    MappingOf,
    given_in_sidecar,
    mappings,
    no_mapping,
    one_mapping,
)
from nxt_twin.recording.recording import Recording
from nxt_twin.recording.tacho_steps import untold_step
from nxt_twin.recording.yaml_file import read_model

if TYPE_CHECKING:
    from nxt_twin.recording.any_mapping import AnyMapping

PlantSource = dict[str, Any] | str

_CASE_FILE = "case.yaml"
_DEFAULT_PLANT = "nxt_motor"
_SENSOR_SUFFIX = "_sensor"
ROBOT_KIND = "differential_drive"
_ROBOT_MEND = (
    "write `plant: {kind: differential_drive, left: b, right: c, left_wheel_radius_m: 0.028, "
    "right_wheel_radius_m: 0.028, track_m: 0.103}` into the table's NAME.yaml"
)


@final
@dataclass(frozen=True, repr=False)
class Case:
    """Everything that a diagnosis may see.

    Attributes:
        name: the folder's name, or a single recording's.
        folder: where it lies.
        plant: the baseline as written: its keys, a name, or the path of a file.
        recordings: the runs to fit.
        holdout: runs that must not be fitted.
        port: the port whose motor the case is about; None for a mapped plant, a sensor or a robot.
        before: runs made while the baseline held, where the question is what has changed since.
    """

    name: str
    folder: Path
    plant: PlantSource
    recordings: tuple[Recording, ...]
    holdout: tuple[Recording, ...]
    port: Port | None
    before: tuple[Recording, ...] = ()

    def __repr__(self) -> str:
        """Short: name and recordings."""
        held_out = f", {len(self.holdout)} held out" if self.holdout else ""
        return f"<Case {self.name}: {len(self.recordings)} recordings{held_out}>"

    def remarks(self) -> tuple[str, ...]:
        """What had to be found of its recordings, because no file tells it; a line each."""
        port = self.port
        whole = (*self.recordings, *self.holdout, *self.before)
        return tuple(filter(None, (untold_step(each, port) for each in whole))) if port else ()


@final
class CaseFile(BaseModel):
    """The keys of `case.yaml`."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    plant: str | dict[str, Any]
    recordings: list[str]
    holdout: list[str] = []
    before: list[str] = []
    port: Port | None = None
    mapping: GivenMapping = None


def read_as_case(path: Path, mapping_of: MappingOf | None = None) -> Case:
    """Read a case folder (or its `case.yaml`), or a single recording as a case of its own.

    Args:
        path: of either.
        mapping_of: gives the mapping of each recording, in the place of what the case or sidecar states.

    A single recording's sidecar may name its `plant` (`nxt_motor` if it does not) and, for a table from
    elsewhere, its `mapping` file.

    Raises:
        CaseError, RecordingError, MappingError, PlantError: as `read_case`.
    """
    if path.name == _CASE_FILE or (path / _CASE_FILE).exists() or (path.is_dir() and not _is_table(path)):
        return read_case(path if path.is_dir() else path.parent, mapping_of)
    file = path.parent / path.name.partition("#")[0]
    sidecar = read_sidecar(file)
    part = part_of(path)
    default = (part and plant_of_part(part)) or _DEFAULT_PLANT
    plant = _located(sidecar.get("plant", default), path.parent)
    recordings = _read(
        path.parent, f"{file.name}{part.episode}" if part else path.name, mapping_of or _beside(path)
    )
    port = _port(recordings, plant, None, str(path))
    return Case(path.stem, path.parent, plant, recordings, (), port)


def with_own_mapping(path: Path) -> tuple[Path, AnyMapping | None]:
    """A table, and the mapping that its sidecar states or that a LeRobot data set has by itself.

    Raises:
        RecordingError, MappingError: there is one, and it cannot be used.
    """
    part = part_of(path)
    table = path.with_name(f"{part.folder.name}{part.episode}") if part else path
    return table, _beside(path)(path.name)


def _beside(path: Path) -> MappingOf:
    if not path.name:
        return no_mapping
    file = path.parent / path.name.partition("#")[0]
    given = given_in_sidecar(read_sidecar(file))
    part = part_of(path) if given is None else None
    return (
        one_mapping(mapping_of_part(part))
        if part
        else mappings(given, path.parent, f"{file.with_suffix('.yaml')}, key mapping")
    )


def read_case(folder: Path, mapping_of: MappingOf | None = None) -> Case:
    """Read a case folder.

    Raises:
        CaseError: if `case.yaml` is missing or wrong, lists a recording twice or none to fit, or leaves the port open.
        RecordingError, MappingError, PlantError: if a file that it names cannot be used.
    """
    if not folder.is_dir():
        what = "is a file where a case folder is expected" if folder.exists() else "there is no such folder"
        raise CaseError(what, where=str(folder), mend=f"name the folder that holds {_CASE_FILE}")
    path = folder / _CASE_FILE
    file = read_model(path, CaseFile, CaseError)
    _check_lists(file, path)
    plant = _located(file.plant, folder)
    stated = mapping_of or mappings(file.mapping, folder, f"{path}, key mapping")
    held_out = {normpath(name) for name in file.holdout}
    fitted = [name for name in file.recordings if normpath(name) not in held_out]
    recordings = tuple(each for name in fitted for each in _read(folder, name, stated))
    holdout = tuple(each for name in file.holdout for each in _read(folder, name, stated))
    before = tuple(each for name in file.before for each in _read(folder, name, stated))
    port = _port((*recordings, *holdout, *before), plant, file.port, str(path))
    return Case(folder.resolve().name, folder, plant, recordings, holdout, port, before)


def case_of(
    recordings: Sequence[Recording], plant: PlantSource | None = None, port: Port | None = None
) -> Case:
    """A case of recordings in memory.

    Args:
        recordings: of one thing, at least one.
        plant: the baseline; else the one that the first recording's sidecar names, else `nxt_motor`.
        port: the port in question; needed where several have both power and count.

    Raises:
        CaseError: there is no recording, or the port is left open.
        PlantError: there is no such plant.
    """
    if not recordings:
        raise CaseError("holds no recording", where="case", mend="give at least one")
    baseline = plant or recordings[0].plant or _DEFAULT_PLANT
    name = Path(recordings[0].name).stem
    return Case(
        name, Path(), baseline, tuple(recordings), (), _port(recordings, baseline, port, recordings[0].name)
    )


def _check_lists(file: CaseFile, path: Path) -> None:
    """Raise where nothing is left to fit or a file is listed twice; `holdout` may name some of the `recordings`."""
    where = f"{path}, key recordings"
    if not file.recordings:
        raise CaseError("lists no recording", where=where, mend="list at least one file")
    recordings, holdout, before = (
        [normpath(name) for name in names] for names in (file.recordings, file.holdout, file.before)
    )
    if set(recordings) <= set(holdout):
        what = "lists no recording that is not held out"
        raise CaseError(what, where=where, mend="leave at least one out of holdout")
    for name, count in Counter([*recordings, *(set(holdout) - set(recordings)), *before]).items():
        if count > 1 or holdout.count(name) > 1:
            mend = "list each file once, to be fitted, held out or before"
            raise CaseError(f"lists {name} twice", where=str(path), mend=mend)


def _located(plant: PlantSource, folder: Path) -> PlantSource:
    """The plant, with the path of its file, if it names one, taken from `folder`."""
    is_file = isinstance(plant, str) and Path(plant).suffix.lower() in (".yaml", ".yml")
    return str(folder / str(plant)) if is_file else plant


def _is_table(folder: Path) -> bool:
    """Whether a folder is a bag or a LeRobot data set."""
    return any((folder / name).exists() for name in ("metadata.yaml", "meta/info.json"))


def _read(folder: Path, name: str, mapping_of: MappingOf) -> tuple[Recording, ...]:
    """A file's recordings under its name in the case; a table that is split gives several."""
    path = folder / name
    mapping = mapping_of(name)
    if mapping is None:
        return (replace(read_recording(path), name=name),)
    from nxt_twin.recording.mapped import read_all_mapped  # with the models of mappings: slow

    found = read_all_mapped(path, mapping)
    return (replace(found[0], name=name),) if len(found) == 1 else found


def _port(recordings: Sequence[Recording], plant: PlantSource, named: Port | None, where: str) -> Port | None:
    """The port that the case is about: the one named, or the only one with a motor in every recording."""
    config = load_plant_config(plant) if isinstance(plant, str) else plant
    kind = str(config.get("kind"))
    if recordings[0].kinds is not None or kind.endswith(_SENSOR_SUFFIX) or kind == ROBOT_KIND:
        return None
    motors = [port for port in PORTS if all(_has_motor(recording, port) for recording in recordings)]
    if named is not None and named not in motors:
        mend = f"ports with both in every recording: {', '.join(motors) or 'none'}"
        need = f"{power_column(named)} and {tacho_column(named)}"
        raise CaseError(f"port {named} lacks {need}", where=where, mend=mend)
    if named is not None:
        return named
    if len(motors) != 1 and all(POSE_X in recording.columns for recording in recordings):
        raise CaseError("holds a robot's pose, but its plant is of one motor", where=where, mend=_ROBOT_MEND)
    if len(motors) != 1:
        found = f"ports {', '.join(motors)} have" if motors else "no port has"
        mend = (
            "name one as `port:` in case.yaml" if motors else "record X_power_pct and X_tacho_deg of a port"
        )
        raise CaseError(f"{found} both power and tacho", where=where, mend=mend)
    return motors[0]


def _has_motor(recording: Recording, port: Port) -> bool:
    columns = recording.columns
    tacho = columns.get(tacho_column(port))
    is_driven = power_column(port) in columns or goal_column(port) in columns
    return is_driven and tacho is not None and not np.isnan(tacho).all()
