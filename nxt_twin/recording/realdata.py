"""Other people's recordings of real motors, turned into case folders on the user's own disk."""

from __future__ import annotations

import csv
import os
import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import pi
from pathlib import Path
from types import MappingProxyType
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import CaseError, MissingDataError, RecordingError
from nxt_twin.recording.configs import configs_dir
from nxt_twin.recording.files import write_recording
from nxt_twin.recording.recording import Recording
from nxt_twin.recording.source import nearest_name, quoted
from nxt_twin.recording.tables.lines import WHITESPACE, TextLayout
from nxt_twin.recording.tables.text import read_text

DATA_VARIABLE = "NXT_TWIN_DATA"

_ADVICE = f"docs/real-data.md says where to get it; then set {DATA_VARIABLE} to its folder"
_STEP_DUTIES_PCT = (10, 20, 30, 40, 50, 60, 70, 80, 100)
_SINE_SPEEDS_RAD_S = (pi, 2 * pi, 3 * pi)
_EV3_LAYOUT = TextLayout(delimiter=WHITESPACE, header=False)


@final
@dataclass(frozen=True)
class DataSet:
    """One data set.

    Attributes:
        folder: its files' folder below the data root.
        fill: brings its recordings from that folder into a case folder.
        has_mapping: whether the case reads them through the mapping file of the data set's name.
    """

    folder: Path
    fill: Callable[[Path, Path], None]
    has_mapping: bool


def data_root() -> Path:
    """The folder that holds the data sets: `$NXT_TWIN_DATA`, else `shared/data` beside the source checkout.

    Raises:
        MissingDataError: if neither is there.
    """
    named = os.environ.get(DATA_VARIABLE)
    if named:
        if not Path(named).is_dir():
            raise MissingDataError("is no folder", where=f"{DATA_VARIABLE}={named}", mend=_ADVICE)
        return Path(named)
    checkout = configs_dir().parent
    beside = checkout.parent / "shared" / "data"
    if (checkout / "pyproject.toml").is_file() and beside.is_dir():
        return beside
    raise MissingDataError("the real recordings are not on this machine", mend=_ADVICE)


def prepare_case(name: str, data: Path, out: Path) -> Path:
    """Make the case folder `out/name` of a data set; files already there are written anew.

    Args:
        name: `emps`, `ev3-large`, `nxt-step` or `nxt-ultrasonic`.
        data: the data root, as from `data_root`.
        out: the folder to make it in.

    Returns:
        The case folder, ready for `read_case`.

    Raises:
        CaseError: if there is no such data set or the folder cannot be written.
        MissingDataError: if a file of the data set is missing.
    """
    if name not in DATA_SETS:
        mend = f"nearest known: {nearest_name(name, DATA_SETS)}; known: {', '.join(DATA_SETS)}"
        raise CaseError(f"there is no data set {quoted(name)}", mend=mend)
    data_set = DATA_SETS[name]
    folder = out / name
    configs = configs_dir()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        data_set.fill(data / data_set.folder, folder)
        shutil.copyfile(configs / "cases" / name / "case.yaml", folder / "case.yaml")
        if data_set.has_mapping:
            shutil.copyfile(configs / "mappings" / f"{name}.yaml", folder / f"{name}.yaml")
    except OSError as failure:
        raise CaseError(f"cannot be written: {failure}", where=str(folder)) from None
    return folder


def _copy(*names: str) -> Callable[[Path, Path], None]:
    def fill(source: Path, folder: Path) -> None:
        for name in names:
            shutil.copyfile(_existing(source / name), folder / name)

    return fill


def _fill_ev3_large(source: Path, folder: Path) -> None:
    """The duty of a step is in force from the first row; that of a sine is what the row's stamp gives."""
    for duty in (sign * size for size in _STEP_DUTIES_PCT for sign in (1, -1)):
        name = f"step_{'p' if duty > 0 else 'm'}{abs(duty)}.csv"
        time_s, angle_deg = _read_ev3(source / f"data_for_voltage_{duty}_.txt")
        _write_ev3(folder / name, time_s, np.full(time_s.size, float(duty)), angle_deg)
    for speed in _SINE_SPEEDS_RAD_S:
        time_s, angle_deg = _read_ev3(source / f"data_for__{speed}_.txt")
        _write_ev3(folder / f"sine_w{speed:.2f}.csv", time_s, 100.0 * np.sin(speed * time_s), angle_deg)


def _read_ev3(path: Path) -> tuple[FloatArray, FloatArray]:
    table = read_text(_existing(path), _EV3_LAYOUT, lambda names: dict.fromkeys(names, "number"))
    if set(table.numbers) != {"c1", "c2"}:
        raise RecordingError("has not the two columns angle and time", where=str(path), mend=_ADVICE)
    return table.numbers["c2"], table.numbers["c1"]


def _write_ev3(path: Path, time_s: FloatArray, power_pct: FloatArray, tacho_deg: FloatArray) -> None:
    columns = {"time_s": time_s, "a_power_pct": power_pct, "a_tacho_deg": tacho_deg}
    write_recording(Recording(path.name, columns), path)


def _fill_ultrasonic(source: Path, folder: Path) -> None:
    """Stamps and whole centimetres; the other columns were derived from them. Its header is Latin-1."""
    path = _existing(source / "sepTest.csv")
    _, *rows = csv.reader(path.read_text(encoding="latin-1").splitlines())
    try:
        time_s, distance_cm = np.array([[float(cell) for cell in row[:2]] for row in rows]).T
    except ValueError:
        what = "has not the two columns time and distance"
        raise RecordingError(what, where=str(path), mend=_ADVICE) from None
    columns = {"time_s": time_s, "s4_ultrasonic_cm": distance_cm}
    write_recording(Recording(path.name, columns), folder / path.name)


def _existing(path: Path) -> Path:
    if not path.is_file():
        raise MissingDataError("there is no such file", where=str(path), mend=_ADVICE)
    return path


DATA_SETS: Mapping[str, DataSet] = MappingProxyType(
    {
        "emps": DataSet(Path("emps"), _copy("DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"), has_mapping=True),
        "ev3-large": DataSet(Path("ev3-large-kvitaliiy", "lab2"), _fill_ev3_large, has_mapping=False),
        "nxt-step": DataSet(
            Path("nxt-motor-step-ari"), _copy("motor_data_identifikace.txt"), has_mapping=True
        ),
        "nxt-ultrasonic": DataSet(Path("nxt-ultrasonic"), _fill_ultrasonic, has_mapping=False),
    }
)
