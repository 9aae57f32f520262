"""A recording for programs that draw runs: curves by name, and remarks at their times."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import NxtTwinError
from nxt_twin.recording.columns import CATALOGUE, TIME
from nxt_twin.recording.recording import Recording

MEASURED: Final = "measured"
PREDICTED: Final = "predicted"


@final
@dataclass(frozen=True)
class Curve:
    """A column where it was sampled.

    Attributes:
        side: `measured`, or `predicted` by a twin.
        column: its name; of a mapped recording `input`, `output` and so on.
        time_s: shape (samples,).
        values: shape (samples,); modes are numbers, 0 for drive.
    """

    side: str
    column: str
    time_s: FloatArray
    values: FloatArray


@final
@dataclass(frozen=True)
class Remark:
    """A diagnosis' words on a moment, s on the recording's clock."""

    time_s: float
    text: str


@final
@dataclass(frozen=True)
class DrawnRun:
    """A recording's curves and remarks.

    Attributes:
        name: the recording's.
        curves: measured ones first.
        remarks: in the order of time.
    """

    name: str
    curves: tuple[Curve, ...]
    remarks: tuple[Remark, ...] = ()


def drawn_run(
    recording: Recording,
    predicted: Mapping[str, FloatArray] | None = None,
    diagnosis: Mapping[str, Any] | None = None,
) -> DrawnRun:
    """The curves of a recording, with a twin's beside them.

    Args:
        recording: whose.
        predicted: what a twin expects, by column, one value a row.
        diagnosis: the JSON of a diagnosis of which the recording was a part.

    Raises:
        NxtTwinError: the diagnosis lacks what one has.
    """
    measured = [
        _curve(MEASURED, name, recording.time_s, values)
        for name, values in recording.columns.items()
        if name != TIME
    ]
    twins = [_curve(PREDICTED, name, recording.time_s, each) for name, each in (predicted or {}).items()]
    curves = tuple(curve for curve in (*measured, *twins) if curve.time_s.size)
    return DrawnRun(recording.name, curves, _remarks(recording, diagnosis) if diagnosis else ())


def unit_of_column(column: str) -> str:
    """The unit of a column of a brick's recording; empty where it has none."""
    known = CATALOGUE.get(column)
    return known.unit if known else ""


def _curve(side: str, column: str, time_s: FloatArray, values: FloatArray) -> Curve:
    sampled = np.isfinite(values)
    return Curve(side, column, time_s[sampled], values[sampled])


def _remarks(recording: Recording, diagnosis: Mapping[str, Any]) -> tuple[Remark, ...]:
    start_s = float(recording.time_s[0])
    try:
        remarks = [Remark(start_s, f"{diagnosis['verdict']}: {diagnosis['sentence']}")]
        spells = [each for each in diagnosis["mismatch"]["when"] if each["recording"] == recording.name]
        for spell in spells:
            text = f"departs from the baseline by {spell['strength']:.3g} sigma until {spell['end_s']:.2f} s"
            remarks.append(Remark(start_s + spell["start_s"], text))
    except (KeyError, TypeError, ValueError):
        mend = "name a file of nxt-twin diagnose --json"
        raise NxtTwinError("is no diagnosis", where="--diagnosis", mend=mend) from None
    return tuple(sorted(remarks, key=lambda remark: remark.time_s))
