"""Seconds of a diagnosis of four recordings with as many readings as half a minute of each at 150 Hz has."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from nxt_twin.blind.make import make_case, write_case
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.recording.case import Case, read_case

_SEED = 162
_RECORDINGS, _DURATION_S = 4, 45.0  # at 100 Hz: 18 000 readings
_CONCEALED: tuple[tuple[str, ...], ...] = ((), ("gravity_load",), ("cogging", "battery_sag"))
_MOST_S = 10.0


def _case(concealed: tuple[str, ...], *, duration_s: float) -> Case:
    size = "medium" if concealed else None
    made = make_case(_SEED, effects=concealed, size=size, duration_s=duration_s, recordings=_RECORDINGS)
    with tempfile.TemporaryDirectory() as folder:
        return read_case(write_case(made, Path(folder) / "cases", Path(folder) / "answers"))


def report() -> list[str]:
    """Wall and processor time of one diagnosis for each case; compilation is excluded."""
    diagnose(_case((), duration_s=5.0))
    lines = [f"{_RECORDINGS} recordings x {_DURATION_S:g} s at 100 Hz; compilation is excluded"]
    for concealed in _CONCEALED:
        case = _case(concealed, duration_s=_DURATION_S)
        began, worked = time.perf_counter(), time.process_time()
        found = diagnose(case).diagnosis
        wall_s, cpu_s = time.perf_counter() - began, time.process_time() - worked
        named = ", ".join(effect.id for effect in found.effects) or "nothing"
        met = "met" if wall_s <= _MOST_S else "MISSED"
        lines.append(
            f"{', '.join(concealed) or 'nothing'} -> {found.verdict}, {named}: "
            f"{wall_s:.1f} s (aim <= {_MOST_S:g}: {met}), processor {cpu_s:.1f} s"
        )
    return lines
