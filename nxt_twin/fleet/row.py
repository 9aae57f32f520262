"""A row of the fleet's table: what one case said, or why it said nothing."""

from __future__ import annotations

import math
from typing import Any, Final, Literal

import pyarrow as pa

from nxt_twin.diagnose.diagnosis import Diagnosis, Estimate, Moved
from nxt_twin.fleet.finding.labels import Labels

Row = dict[str, Any]
"""Plain values by the names of `SCHEMA`."""

FailureKind = Literal["recording", "program", "worker", "reading"]
TRANSIENT: Final[tuple[FailureKind, ...]] = ("worker", "reading")
"""Failures that another run may not meet: it tries again."""

_ESTIMATE: Final = (
    ("value", pa.float64()),
    ("std", pa.float64()),
    ("own_std", pa.float64()),
    ("low_95", pa.float64()),
    ("high_95", pa.float64()),
    ("unit", pa.string()),
)
SCHEMA: Final = pa.schema(
    [
        ("unit", pa.string()),
        ("session", pa.string()),
        ("batch", pa.string()),
        ("when", pa.timestamp("ms", "UTC")),
        ("source", pa.string()),
        ("key", pa.string()),
        ("engine", pa.string()),
        ("failure", pa.string()),
        ("error", pa.string()),
        ("verdict", pa.string()),
        ("sentence", pa.string()),
        ("fit_unit", pa.string()),
        ("fit_baseline", pa.float64()),
        ("fit_improved", pa.float64()),
        ("fit_floor", pa.float64()),
        ("false_alarm_rate", pa.float64()),
        ("tried", pa.int32()),
        ("parameters", pa.list_(pa.struct([("name", pa.string()), ("given", pa.float64()), *_ESTIMATE]))),
        (
            "effects",
            pa.list_(
                pa.struct(
                    [
                        ("id", pa.string()),
                        ("probability", pa.float64()),
                        ("parameters", pa.list_(pa.struct([("name", pa.string()), *_ESTIMATE]))),
                    ]
                )
            ),
        ),
    ]
)
"""The table's columns, as docs/fleet.md tells them."""


def row_of(diagnosis: Diagnosis) -> Row:
    """The columns that a diagnosis adds to a row."""
    alarms = diagnosis.false_alarm_rate
    tried = {one.id for one in diagnosis.detectable} | {one.id for one in diagnosis.effects}
    return {
        "verdict": diagnosis.verdict,
        "sentence": diagnosis.sentence,
        "fit_unit": diagnosis.fit.unit,
        "fit_baseline": _finite(diagnosis.fit.baseline),
        "fit_improved": _finite(diagnosis.fit.improved),
        "fit_floor": _finite(diagnosis.fit.floor),
        "false_alarm_rate": alarms.upper_95 if alarms else None,
        "tried": len(tried),
        "parameters": [
            {"name": name, "given": _finite(moved.before), **_estimate(moved, moved.after)}
            for name, moved in diagnosis.refit.items()
        ],
        "effects": [
            {
                "id": effect.id,
                "probability": effect.probability,
                "parameters": [
                    {"name": name, **_estimate(each, each.value)} for name, each in effect.params.items()
                ],
            }
            for effect in diagnosis.effects
        ],
    }


def failed(kind: FailureKind, error: str) -> Row:
    """The columns that a failure adds to a row: one line of text."""
    return {"failure": kind, "error": " ".join(error.split())}


def completed(row: Row, labels: Labels, source: str, key: str, engine: str) -> Row:
    """A row with whose it is, and nothing where it says nothing."""
    when = labels.when
    whose = {
        "unit": labels.unit,
        "session": labels.session,
        "batch": labels.batch or None,
        "when": None if when is None else int(1000 * when.timestamp()),
        "source": source,
        "key": key,
        "engine": engine,
    }
    return {**dict.fromkeys(SCHEMA.names), **whose, **row}


def _estimate(one: Estimate | Moved, value: float) -> Row:
    low, high = one.interval_95 or (None, None)
    return {
        "value": _finite(value),
        "std": _finite(one.std),
        "own_std": _finite(_own_std(one, value)),
        "low_95": _finite(low),
        "high_95": _finite(high),
        "unit": one.unit,
    }


def _own_std(one: Estimate | Moved, value: float) -> float:
    """The standard deviation without the doubt of the anchors, which all sessions share."""
    if one.ratio is None or not one.ratio.value:
        return one.std
    return min(one.std, abs(value * one.ratio.std / one.ratio.value))


def _finite(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)
