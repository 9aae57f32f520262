"""From a fleet's table to all that it says."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from nxt_twin.fleet.findings.batches import commons
from nxt_twin.fleet.findings.by_unit import drifts, outliers
from nxt_twin.fleet.findings.columns import read_sessions
from nxt_twin.fleet.findings.lacks import lacks
from nxt_twin.fleet.findings.values import LEVEL, Failed, Findings


def findings_in(path: Path) -> Findings:
    """The findings in the table at `path`, with false discoveries controlled over the whole fleet.

    Each of the four questions is a family of tests of its own.

    Raises:
        FleetError: the file is no fleet's table.
    """
    sessions, failed = read_sessions(path)
    found, shares = lacks(sessions)
    sure = tuple(lack for lack in found if lack.q <= LEVEL)
    far, parameters = outliers(sessions, LEVEL)
    columns = [failed[name].to_pylist() for name in ("unit", "session", "error")]
    return Findings(
        sessions=sessions.unit.size + failed.num_rows,
        units=len(sessions.units),
        verdicts=dict(Counter(sessions.table["verdict"].to_pylist())),
        shares=tuple(shares),
        lacks=sure,
        possible=len(found) - len(sure),
        drifts=tuple(drifts(sessions, LEVEL)),
        commons=tuple(commons(sessions, LEVEL)),
        outliers=tuple(far),
        parameters=tuple(parameters),
        failed=tuple(Failed(*each) for each in zip(*columns, strict=True)),
    )
