"""A comparison as JSON: the keys of a diagnosis, and what changed."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Any

from nxt_twin.diagnose.changed.answer import Changes
from nxt_twin.diagnose.telling.to_json import SCHEMA, effect_to_json, finite, moved_to_json


def to_json(changes: Changes) -> str:
    """The JSON text; a number that is not finite becomes null."""
    content: dict[str, Any] = {
        "schema": SCHEMA,
        "case": changes.name,
        "before": changes.before,
        "verdict": changes.verdict,
        "sentence": changes.sentence,
        "changes": [asdict(change) for change in changes.changes],
        "refit": {name: moved_to_json(each) for name, each in changes.refit.items()},
        "mismatch": {
            "channel": changes.mismatch.channel,
            "when": [],
            "regimes": [],
            "equation": changes.mismatch.equation,
        },
        "effects": [effect_to_json(effect) for effect in changes.effects],
        "alternatives": [asdict(other) for other in changes.alternatives],
        "fit": asdict(changes.fit),
        "tolerance": asdict(changes.tolerance),
        "next_experiment": None,
        "notes": list(changes.notes),
    }
    return json.dumps(finite(content), ensure_ascii=False, indent=1)
