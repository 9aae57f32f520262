"""Whole diagnoses of concealed cases: time, work, and the same problem by two plain recipes."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from unittest.mock import patch

import numpy as np

from benchmarks.diagnosis_peers import Peer, one_by_one, sparse_regression
from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.blind.make import make_case, write_case
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.diagnose.fitting.problem import problem_of
from nxt_twin.physics.simulate import Job, Result, Simulator
from nxt_twin.recording.case import Case, read_case

_CONCEALED: tuple[tuple[str, ...], ...] = (
    ("stiction",),
    (),
    ("gravity_load",),
    ("command_delay",),
    ("shaft_compliance",),
    ("cogging", "battery_sag"),
    ("quadratic_drag", "constant_load"),
    ("spring_load", "stale_samples", "stiction"),
    ("backlash",),
    (),
    ("inductance",),
    ("end_stop",),
    ("clock_skew",),
    ("missed_counts",),
    ("presliding",),
    (),
    ("winding_heating", "gravity_load"),
    ("coulomb_friction", "backlash"),
    ("command_delay", "friction_warmup", "cogging"),
    ("presliding", "quadratic_drag", "current_limit"),
)
_FIRST_SEED = 140
_DURATION_S = 30.0
_MEDIAN_S, _P95_S = 5.0, 15.0


def report() -> list[str]:
    """Seconds, CPU seconds and steps of the search over several cases, and the peers on the first of them."""
    diagnose(_case((), seed=4, duration_s=5.0))
    lines, walls, cpus, steps = [], [], [], []
    for number, concealed in enumerate(_CONCEALED):
        case = _case(concealed, seed=_FIRST_SEED + number, duration_s=_DURATION_S)
        with _Counter() as counter:
            began, worked = time.perf_counter(), time.process_time()
            found = diagnose(case).diagnosis
            walls.append(time.perf_counter() - began)
            cpus.append(time.process_time() - worked)
        steps.append(counter.steps)
        named = ", ".join(effect.id for effect in found.effects) or "nothing"
        lines.append(
            f"{', '.join(concealed) or 'nothing'} -> {found.verdict}, {named}: {walls[-1]:.1f} s, "
            f"CPU {cpus[-1]:.1f} s, {counter.runs} runs, {counter.steps / 1e6:.0f} million steps"
        )
    median, p95 = float(np.median(walls)), float(np.percentile(walls, 95))
    return [
        f"3 recordings x {_DURATION_S:g} s at 100 Hz, the whole library; compilation is excluded",
        *lines,
        f"median {median:.1f} s (aim <= {_MEDIAN_S:g}: {_said(median, _MEDIAN_S)}), 95th percentile {p95:.1f} s "
        f"(aim <= {_P95_S:g}: {_said(p95, _P95_S)}); CPU median {np.median(cpus):.1f} s, "
        f"steps median {np.median(steps) / 1e6:.0f} million",
        "",
        *_peers(walls[0]),
    ]


def _peers(ours_s: float) -> list[str]:
    case = _case(_CONCEALED[0], seed=_FIRST_SEED, duration_s=_DURATION_S)
    problem = problem_of(case.name, case.plant, case.recordings, case.holdout, case.port)
    rows = [
        ("least_squares over solve_ivp, one candidate after another", one_by_one(problem.signals)),
        ("PySINDy on the discrepancy", sparse_regression(problem.signals)),
    ]
    return [f"the first case ({', '.join(_CONCEALED[0])}), {ours_s:.1f} s here, by other means:"] + [
        f"{title}: {peer.taken_s:.1f} s, {peer.taken_s / ours_s:.1f} times ours; named {_named(peer)}; {peer.words}"
        for title, peer in rows
    ]


def _named(peer: Peer) -> str:
    return ", ".join(peer.named) or "nothing"


def _said(value: float, bound: float) -> str:
    return "met" if value <= bound else "MISSED"


def _case(concealed: tuple[str, ...], seed: int, duration_s: float) -> Case:
    made = make_case(seed, effects=concealed, size="medium" if concealed else None, duration_s=duration_s)
    with tempfile.TemporaryDirectory() as folder:
        return read_case(write_case(made, Path(folder) / "cases", Path(folder) / "answers"))


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
