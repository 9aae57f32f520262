"""A thousand parameter sets in one call, on one core and on all."""

from __future__ import annotations

import os
from functools import partial

import numpy as np

from benchmarks.steps import DURATION_S, motor, steps
from benchmarks.timing import times_s
from nxt_twin.physics.simulate import STEP_S, Simulator, free_job
from nxt_twin.physics.start import at_rest

_SETS = 1000
_ROUNDS = 5


def report() -> list[str]:
    """Time, throughput and how well the work spreads over the cores."""
    plant, signals = motor(), steps()
    job = free_job(signals, at_rest(signals))
    value, active = plant.vectors()
    values = value * np.random.default_rng(0).uniform(0.8, 1.2, (_SETS, value.size))
    masks = np.repeat(active[None], _SETS, axis=0)
    count = _SETS * round(DURATION_S / STEP_S)
    cores = os.cpu_count() or 1
    with Simulator(plant.layout, workers=1) as single, Simulator(plant.layout, workers=cores) as full:
        taken_s: list[list[float]] = [[], []]
        for warm in range(_ROUNDS + 1):
            for taken, simulator in zip(taken_s, (single, full), strict=True):
                once = times_s(partial(simulator.run, values, masks, [job]), 1)
                taken.extend(once if warm else [])
    alone_s, together_s = (min(taken) for taken in taken_s)
    return [
        f"{_SETS} parameter sets x {DURATION_S:g} s at {1e3 * STEP_S:g} ms, {count / 1e6:g} million steps",
        f"1 worker: {alone_s:.2f} s, {count / alone_s / 1e6:.1f} million steps/s",
        f"as many as cores ({cores}): {together_s:.2f} s, {count / together_s / 1e6:.1f} million steps/s",
        f"scaling efficiency: {alone_s / (cores * together_s):.0%}",
        f"quickest of {_ROUNDS} warm runs each, in turn: compilation and the first run are excluded",
    ]
