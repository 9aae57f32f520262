"""A plain fit of simulated windows by scipy: what a re-fitted baseline is held against.

It shares the kernel with the engine, and nothing of how the engine fits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Simulator, free_job
from nxt_twin.physics.start import restarts

WINDOW_S = 2.0
STEP_S = 2e-3
SOFT_RAD = np.deg2rad(2.0)
NUDGE = 1e-2
CONSTANT, BACK_EMF = Slot("base", "torque_constant"), Slot("base", "back_emf")
FREE = (
    CONSTANT,
    Slot("base", "resistance"),
    Slot("base", "inertia"),
    Slot("coulomb_friction", "coulomb"),
    Slot("viscous_friction", "viscous"),
)


def fitted_on_windows(
    simulator: Simulator,
    plant: Plant,
    recordings: Sequence[Signals],
    shown: Sequence[BoolArray],
    free: Sequence[Slot] = FREE,
) -> Plant:
    """`plant` with five parameters fitted to windows of 2 s that start from smoothed readings.

    `shown` has, for each of `recordings`, the samples that may be fitted. `free` may hold
    positive parameters of effects too.
    """
    jobs = [replace(free_job(one, restarts(one, WINDOW_S)), step_s=STEP_S) for one in recordings]
    kept = [mask & ~job.start.at for mask, job in zip(shown, jobs, strict=True)]
    _, active = plant.vectors()

    def at(logs: FloatArray) -> Plant:
        new = {slot: float(plant.values[slot] * np.exp(log)) for slot, log in zip(free, logs, strict=True)}
        return plant.with_values({**new, BACK_EMF: plant.values[BACK_EMF] * float(np.exp(logs[0]))})

    def misses(points: FloatArray) -> FloatArray:
        values = np.array([at(logs).vectors()[0] for logs in points])
        runs = simulator.run(values, np.repeat(active[None], len(points), axis=0), jobs)
        return np.concatenate(
            [
                (job.signals.measured - run.predicted)[:, mask]
                for job, run, mask in zip(jobs, runs, kept, strict=True)
            ],
            axis=1,
        )

    def slopes(logs: FloatArray) -> FloatArray:
        ahead, behind = (misses(logs + sign * NUDGE * np.eye(logs.size)) for sign in (1.0, -1.0))
        return np.asarray((ahead - behind).T / (2.0 * NUDGE))

    fit = least_squares(
        lambda logs: misses(logs[None])[0],
        np.zeros(len(free)),
        jac=slopes,
        loss="soft_l1",
        f_scale=SOFT_RAD,
        bounds=(-1.5, 1.5),
        max_nfev=25,
    )
    return at(fit.x)
