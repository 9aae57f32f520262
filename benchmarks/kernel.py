"""One run of the compiled kernel, beside SciPy's LSODA at equal accuracy."""

from __future__ import annotations

from statistics import median

import numpy as np

from benchmarks.lsoda import as_a_user, motor_of, reference
from benchmarks.steps import DURATION_S, motor, steps
from benchmarks.timing import times_s
from nxt_twin.physics.simulate import STEP_S, Simulator, free_job
from nxt_twin.physics.start import at_rest

_LADDER = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7)


def report() -> list[str]:
    """Both solvers' errors against a tight reference, their times, and the ratio."""
    plant, signals = motor(), steps()
    exact = reference(motor_of(plant), signals)
    values, active = plant.vectors()
    job = free_job(signals, at_rest(signals))
    with Simulator(plant.layout, workers=1) as simulator:

        def run() -> list[object]:
            return [result.predicted[0] for result in simulator.run(values[None], active[None], [job])]

        ours = np.abs(run()[0] - exact).max()
        ours_s = median(times_s(run, 15))
    rate = round(DURATION_S / STEP_S) / ours_s / 1e6
    said = [
        f"{DURATION_S:g} s of an NXT motor, {signals.command.size} steps of random level, a reading each 10 ms;",
        "Coulomb friction included, every level above breakaway, so that it reverses but never sticks",
        f"kernel: {1e3 * ours_s:.2f} ms a run, {rate:.1f} million steps/s of {1e3 * STEP_S:g} ms, "
        f"largest error {1e3 * ours:.3g} mrad",
    ]
    for rtol in _LADDER:
        theirs = np.abs(as_a_user(motor_of(plant), signals, rtol) - exact).max()
        if theirs <= ours:
            break
    else:
        return [*said, f"LSODA does not reach that error down to rtol {_LADDER[-1]:g}"]
    theirs_s = median(times_s(lambda: as_a_user(motor_of(plant), signals, rtol), 5))
    return [
        *said,
        f"LSODA (solve_ivp, restarted at each command, rtol {rtol:g}): {1e3 * theirs_s:.0f} ms a run, "
        f"largest error {1e3 * theirs:.3g} mrad",
        f"ratio at equal accuracy: {theirs_s / ours_s:.0f}",
        "errors are of the angle at the readings, against LSODA at rtol 1e-10 with reversals met as events;",
        "times are medians of warm runs: compilation and the first run are excluded",
    ]
