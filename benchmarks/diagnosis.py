"""One whole diagnosis of a concealed case."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from unittest.mock import patch

from nxt_twin.blind.make import make_case, write_case
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.physics.simulate import BoolArray, Job, Result, Simulator
from nxt_twin.recording.case import Case, read_case
from nxt_twin.recording.recording import FloatArray

_CONCEALED = "stiction"


def report() -> list[str]:
    """Seconds from a case to its diagnosis, and how many steps that simulated."""
    case, rehearsal = _case(seed=3, duration_s=15.0), _case(seed=4, duration_s=5.0)
    diagnose(rehearsal)
    with _Counter() as counter:
        began = time.perf_counter()
        found = diagnose(case).diagnosis
        taken_s = time.perf_counter() - began
    named = ", ".join(effect.id for effect in found.effects) or "nothing"
    return [
        f"3 recordings x 15 s of a motor with {_CONCEALED} concealed: {taken_s:.1f} s",
        f"{counter.runs} runs in batches, {counter.steps / 1e6:.0f} million steps, "
        f"{counter.steps / taken_s / 1e6:.1f} million steps/s all in all",
        f"verdict: {found.verdict}, {named}",
        "compilation is excluded: another case was diagnosed before",
    ]


def _case(seed: int, duration_s: float) -> Case:
    case = make_case(seed, effects=(_CONCEALED,), size="medium", duration_s=duration_s)
    with tempfile.TemporaryDirectory() as folder:
        return read_case(write_case(case, Path(folder) / "cases", Path(folder) / "answers"))


class _Counter:
    """Counts what `Simulator.run` is asked for while it is open."""

    def __init__(self) -> None:
        self.runs = 0
        self.steps = 0.0
        self._original = Simulator.run
        self._patch = patch.object(Simulator, "run", self._counting())

    def __enter__(self) -> _Counter:
        self._patch.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._patch.stop()

    def _counting(self) -> object:
        def run(
            simulator: Simulator, values: FloatArray, active: BoolArray, jobs: Sequence[Job]
        ) -> list[Result]:
            self.runs += values.shape[0] * len(jobs)
            for job in jobs:
                span_s = job.signals.time_s[-1] - job.signals.time_s[0]
                self.steps += values.shape[0] * float(span_s) / job.step_s
            return self._original(simulator, values, active, jobs)

        return run
