"""A worker's task: unpack a case, diagnose it, answer with a row. No recording makes it raise."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import yaml

from nxt_twin.diagnose.diagnosis import Diagnosis
from nxt_twin.errors import CaseError, NxtTwinError
from nxt_twin.fleet.parcel import Options, Parcel
from nxt_twin.fleet.row import Row, completed, failed, row_of
from nxt_twin.fleet.version import engine_version
from nxt_twin.recording.case import Case, read_case
from nxt_twin.recording.files import read_sidecar
from nxt_twin.recording.mappings import given_in_sidecar

_CASE_FILE: Final = "case.yaml"
_PLANT: Final = "nxt_motor"


def diagnosed(parcel: Parcel) -> Row:
    """The row of a case; of one that cannot be diagnosed, why."""
    return completed(_said(parcel), parcel.labels, parcel.source, parcel.key, parcel.engine)


def _said(parcel: Parcel) -> Row:
    if parcel.engine != engine_version():
        return failed("worker", f"a worker has the engine {engine_version()}, not {parcel.engine}")
    try:
        with tempfile.TemporaryDirectory(prefix="nxt-twin-fleet-") as folder:
            case = _unpacked(parcel, Path(folder))
        return row_of(_diagnosis(case, parcel.options))
    except NxtTwinError as error:
        return failed("recording", _plain(error))
    except Exception as error:
        return failed("program", f"{type(error).__name__}: {error}")


def _diagnosis(case: Case, options: Options) -> Diagnosis:
    # The engine takes seconds to import: who only plans does without.
    from nxt_twin.diagnose.dispatch import diagnose_any

    return diagnose_any(case, seed=options.seed, tolerance=options.tolerance).diagnosis


def _plain(error: NxtTwinError) -> str:
    """An error's text without the folder that the case was unpacked in."""
    where = Path(error.where.partition(",")[0]).name + "".join(error.where.partition(",")[1:])
    return str(NxtTwinError(error.what, where=where, mend=error.mend))


def _unpacked(parcel: Parcel, folder: Path) -> Case:
    """The case, from its files in an empty folder."""
    for name, content in parcel.files.items():
        path = folder / name
        if not path.resolve().is_relative_to(folder.resolve()):
            raise CaseError("leads out of the case", where=name, mend="name files by paths within the case")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    if parcel.recordings:
        (folder / _CASE_FILE).write_text(yaml.safe_dump(_case_keys(parcel, folder)), encoding="utf-8")
    case = read_case(folder)
    if case.before:
        mend = "compare each with nxt-twin diagnose or nxt-twin changed"
        raise CaseError("asks what has changed since `before`", where=_CASE_FILE, mend=mend)
    labels = parcel.labels
    return replace(case, name=" ".join(filter(None, (labels.unit, labels.session))))


def _case_keys(parcel: Parcel, folder: Path) -> dict[str, Any]:
    """A `case.yaml` for tables: by the fleet's keys, and the first table's sidecar above them."""
    sidecar = read_sidecar(folder / parcel.recordings[0])
    own: dict[str, Any] = {key: sidecar[key] for key in ("plant", "port") if key in sidecar}
    mapping = given_in_sidecar(sidecar)
    own |= {"mapping": mapping} if mapping else {}
    return {"plant": _PLANT, **parcel.keys, **own, "recordings": list(parcel.recordings)}
