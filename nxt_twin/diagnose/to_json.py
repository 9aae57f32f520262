"""A diagnosis as the JSON of contract 4."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from typing import Any

from nxt_twin.diagnose.diagnosis import Diagnosis

SCHEMA = "nxt-twin/diagnosis/1"


def to_json(diagnosis: Diagnosis) -> str:
    """The JSON text; a number that is not finite becomes null."""
    content = {
        "schema": SCHEMA,
        "case": diagnosis.name,
        "verdict": diagnosis.verdict,
        "sentence": diagnosis.sentence,
        "refit": {
            name: {"from": moved.before, "to": moved.after, "std": moved.std, "unit": moved.unit}
            for name, moved in diagnosis.refit.items()
        },
        "mismatch": asdict(diagnosis.mismatch),
        "effects": [asdict(effect) for effect in diagnosis.effects],
        "alternatives": [asdict(alternative) for alternative in diagnosis.alternatives],
        "fit": asdict(diagnosis.fit),
        "held_out": [
            {"recording": run.recording, "baseline": run.baseline_rmse, "improved": run.improved_rmse}
            for run in diagnosis.held_out
        ],
        "next_experiment": asdict(diagnosis.next_experiment) if diagnosis.next_experiment else None,
        "notes": list(diagnosis.notes),
    }
    return json.dumps(_finite(content), ensure_ascii=False, indent=1)


def _finite(value: Any) -> Any:  # noqa: ANN401  # any JSON value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return value
