"""A fleet's findings as JSON."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Final

from nxt_twin.diagnose.telling.to_json import finite
from nxt_twin.fleet.findings.values import LEVEL, Findings

SCHEMA: Final = "nxt-twin/fleet/1"


def to_json(findings: Findings, table: str) -> str:
    """The JSON text; a number that is not finite becomes null."""
    content = {"schema": SCHEMA, "table": table, "false_discovery_rate": LEVEL, **asdict(findings)}
    return json.dumps(finite(content), ensure_ascii=False, indent=1)
