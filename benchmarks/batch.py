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
_REPEATS = 5


def report() -> list[str]:
    """Time, throughput and how well the work spreads over the cores."""
    plant, signals = motor(), steps()
    job = free_job(signals, at_rest(signals))
    value, active = plant.vectors()
    values = value * np.random.default_rng(0).uniform(0.8, 1.2, (_SETS, value.size))
    masks = np.repeat(active[None], _SETS, axis=0)
    count = _SETS * round(DURATION_S / STEP_S)
    cores = os.cpu_count() or 1
    said = [
        f"{_SETS} parameter sets x {DURATION_S:g} s at {1e3 * STEP_S:g} ms, {count / 1e6:g} million steps"
    ]
    quickest_s = []
    for workers in (1, cores):
        with Simulator(plant.layout, workers=workers) as simulator:
            simulator.run(values[:workers], masks[:workers], [job])
            taken_s = times_s(partial(simulator.run, values, masks, [job]), _REPEATS)
        quickest_s.append(min(taken_s))
        rate = count / quickest_s[-1] / 1e6
        said.append(f"{workers} worker(s): {quickest_s[-1]:.2f} s, {rate:.1f} million steps/s")
    if cores > 1:
        said.append(f"scaling efficiency: {quickest_s[0] / (cores * quickest_s[1]):.0%}")
    return [*said, f"quickest of {_REPEATS} warm runs each: compilation and the first run are excluded"]
