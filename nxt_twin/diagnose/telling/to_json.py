"""A diagnosis as the JSON of docs/formats.md#diagnosis-json."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from typing import Any

from nxt_twin.diagnose.diagnosis import Diagnosis, FoundEffect, Mismatch, Moved, NextExperiment

SCHEMA = "nxt-twin/diagnosis/1"


def effect_to_json(effect: FoundEffect) -> dict[str, Any]:
    """An effect's keys; `motor` only where one motor of a robot has it."""
    told = asdict(effect)
    if effect.motor is None:
        del told["motor"]
    return told


def to_json(diagnosis: Diagnosis) -> str:
    """The JSON text; a number that is not finite becomes null."""
    content = {
        "schema": SCHEMA,
        "case": diagnosis.name,
        "verdict": diagnosis.verdict,
        "sentence": diagnosis.sentence,
        "refit": {name: moved_to_json(each) for name, each in diagnosis.refit.items()},
        "mismatch": _mismatch(diagnosis.mismatch),
        "effects": [effect_to_json(effect) for effect in diagnosis.effects],
        "alternatives": [asdict(alternative) for alternative in diagnosis.alternatives],
        "fit": asdict(diagnosis.fit),
        "tolerance": asdict(diagnosis.tolerance) if diagnosis.tolerance else None,
        "held_out": [
            {"recording": run.recording, "baseline": run.baseline_rmse, "improved": run.improved_rmse}
            for run in diagnosis.held_out
        ],
        "next_experiment": _experiment(diagnosis.next_experiment) if diagnosis.next_experiment else None,
        "detectable": [asdict(size) for size in diagnosis.detectable],
        "excitation": asdict(diagnosis.excitation) if diagnosis.excitation else None,
        "false_alarm_rate": asdict(diagnosis.false_alarm_rate) if diagnosis.false_alarm_rate else None,
        "nearest": asdict(diagnosis.nearest) if diagnosis.nearest else None,
        "notes": list(diagnosis.notes),
    }
    return json.dumps(finite(content), ensure_ascii=False, indent=1)


def moved_to_json(one: Moved) -> dict[str, Any]:
    """A parameter before and after, as JSON has it."""
    content = asdict(one)
    return {"from": content.pop("before"), "to": content.pop("after"), **content}


def _mismatch(mismatch: Mismatch) -> dict[str, Any]:
    """The format knows four equations; a transmission's fault shows in the torque balance, and `source` tells it."""
    content = asdict(mismatch)
    if mismatch.equation == "kinematic":
        content["equation"] = "torque_balance"
    return content


def _experiment(experiment: NextExperiment) -> dict[str, Any]:
    program = experiment.program
    return {
        "why": experiment.why,
        "input": experiment.input,
        "expected_nats": experiment.expected_nats,
        "seconds": experiment.seconds,
        "program": None if program is None else program.model_dump(mode="json", exclude_none=True),
    }


def finite(value: Any) -> Any:  # noqa: ANN401  # any JSON value
    """The value with null for each number that is none."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    return value
