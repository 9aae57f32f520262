"""One run of the compiled kernel, beside SciPy's LSODA at equal accuracy."""

from __future__ import annotations

from statistics import median

import numpy as np

from benchmarks.lsoda import as_a_user, motor_of, reference
from benchmarks.steps import DURATION_S, motor, steps
from benchmarks.timing import times_s
from nxt_twin.arrays import FloatArray
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import STEP_S, Simulator, free_job
from nxt_twin.physics.start import at_rest

_AIM = 100.0
_LADDER = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7)


def report() -> list[str]:
    """Both solvers' errors against a tight reference, their times, and the ratio."""
    plant, signals = motor(), steps()
    exact = reference(motor_of(plant), signals)
    ours, ours_s = _kernel(plant, signals, exact)
    rtol, theirs, theirs_s = _lsoda(plant, signals, exact, ours)
    rate = round(DURATION_S / STEP_S) / ours_s / 1e6
    ratio = theirs_s / ours_s
    return [
        f"{DURATION_S:g} s of an NXT motor, {signals.command.size} steps of random level, read each 10 ms;",
        "Coulomb friction included, every level above breakaway, so that it reverses but never sticks",
        f"kernel: {1e3 * ours_s:.2f} ms a run, {rate:.1f} million steps/s of {1e3 * STEP_S:g} ms, "
        f"largest error {1e3 * ours:.3g} mrad",
        f"LSODA (solve_ivp, restarted at each command, rtol {rtol:g}): {1e3 * theirs_s:.0f} ms a run, "
        f"largest error {1e3 * theirs:.3g} mrad",
        f"ratio at equal accuracy: {ratio:.0f} (aim >= {_AIM:g}: {'met' if ratio >= _AIM else 'MISSED'})",
        "errors are of the angle at the readings, against LSODA at rtol 1e-10 with reversals met as events;",
        "times are medians of warm runs: compilation and the first run are excluded",
    ]


def _kernel(plant: Plant, signals: Signals, exact: FloatArray) -> tuple[float, float]:
    """Largest error of the kernel, rad, and the time it takes, s."""
    values, active = plant.vectors()
    job = free_job(signals, at_rest(signals))
    with Simulator(plant.layout, workers=1) as simulator:
        predicted = simulator.run(values[None], active[None], [job])[0].predicted[0]
        taken_s = times_s(lambda: simulator.run(values[None], active[None], [job]), 15)
    return float(np.abs(predicted - exact).max()), median(taken_s)


def _lsoda(plant: Plant, signals: Signals, exact: FloatArray, allowed: float) -> tuple[float, float, float]:
    """The loosest tolerance of the ladder with an error within `allowed`, that error, rad, and its time, s."""
    motor = motor_of(plant)
    for rtol in _LADDER:
        error = float(np.abs(as_a_user(motor, signals, rtol) - exact).max())
        if error <= allowed:
            break
    return rtol, error, median(times_s(lambda: as_a_user(motor, signals, rtol), 5))
