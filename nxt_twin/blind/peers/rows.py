"""All methods beside one another, in the benchmark's measures and in their own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from nxt_twin.blind.by_family import TableRow
from nxt_twin.blind.peers.localised import TRUTH, ChosenCells, f1
from nxt_twin.blind.share import share_of
from nxt_twin.blind.verdict import Judged

_HEAD = (
    "method",
    "single: exact",
    "named among others",
    "clean: called wrong",
    "unknown: misnamed",
    "false discoveries",
    "localisation F1",
)


def peer_rows(judged: Mapping[str, Sequence[Judged]], cells: Sequence[ChosenCells]) -> list[TableRow]:
    """Each method: what it names, what it names falsely, and whether it points at the regimes that are wrong.

    False discoveries are the share of names given that are not hidden there. The F1 counts cells of speed and
    volts in which the model is wrong. It runs over all cases whose effects a regression can express.
    """
    return [_HEAD, *(_row(method, cases, cells) for method, cases in judged.items())]


def _row(method: str, cases: Sequence[Judged], cells: Sequence[ChosenCells]) -> TableRow:
    singles = [case for case in cases if case.kind == "single"]
    told = [one not in case.hidden for case in cases for one in case.named]
    located = f1((own[TRUTH], own[method]) for own in cells if method in own)
    return (
        method,
        str(share_of(case.exact for case in singles)),
        str(share_of(set(case.hidden) <= set(case.named) for case in singles)),
        str(share_of(not case.exact for case in cases if case.kind == "clean")),
        str(share_of(case.misnamed for case in cases if case.kind == "unknown")),
        str(share_of(told)) if told else "names nothing",
        f"{located[0]:.2f} of {located[1]}" if located else "-",
    )
