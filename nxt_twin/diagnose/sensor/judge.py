"""How far a sensor's model is off on what was held out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.diagnosis import HeldOutRun
from nxt_twin.diagnose.sensor.problem import Mask, Values
from nxt_twin.diagnose.sensor.structure import SensorFitter, SensorStructure

_LEARNT_SHARE: Final = 0.2  # first part of a held-out recording, which tells its room light and mains phase
_DRAWS: Final = 8  # sets of readings that are drawn from the model for each recording's noise floor


def held_out_runs(
    fitter: SensorFitter, baseline: SensorStructure, final: SensorStructure
) -> tuple[HeldOutRun, ...]:
    """The held-out readings of each recording beside what the two structures expect there.

    A recording that is held out whole brings room light and mains phase of its own. A structure that has these
    learns them from the recording's first fifth, which then does not count.
    """
    problem, split = fitter.problem, fitter.split
    found = []
    for index, run in enumerate(problem.runs):
        items = split.held_out & (problem.item_run == index)
        if not items.any():
            continue
        learns = run.held_out and any(_is_run_bound(name) for name in final.names)
        learnt, judged = _divided(items) if learns else (np.zeros_like(items), items)
        rows = problem.rows_of_items(index, judged)
        guess = [
            problem.predict(_values_for(fitter, structure, index, learnt), index)[rows]
            for structure in (baseline, final)
        ]
        measured = run.readings[rows]
        found.append(
            HeldOutRun(
                recording=run.name,
                time_s=run.time_s[rows],
                command=run.truth[problem.truth][rows],
                command_label=problem.truth,
                measured=measured,
                baseline=guess[0],
                improved=guess[1],
                stale=np.zeros(measured.size),
                baseline_rmse=_rms(measured - guess[0]),
                improved_rmse=_rms(measured - guess[1]),
            )
        )
    return tuple(found)


def overall(runs: Sequence[HeldOutRun], which: Callable[[HeldOutRun], FloatArray]) -> float:
    """The error over all held-out readings together."""
    return _rms(np.concatenate([run.measured - which(run) for run in runs])) if runs else float("nan")


def noise_floor(fitter: SensorFitter, final: SensorStructure, seed: int) -> float:
    """The error that readings drawn from the final model itself show against its expectation."""
    problem, rng, errors = fitter.problem, np.random.default_rng(seed), []
    for index in range(len(problem.runs)):
        rows = problem.rows_of_items(index, fitter.split.held_out)
        if not rows.any():
            continue
        expected = problem.predict(final.values, index)
        drawn = [problem.draw(final.values, index, rng) for _ in range(_DRAWS)]
        errors += [(one - expected)[rows] for one in drawn]
    return _rms(np.concatenate(errors)) if errors else float("nan")


def _divided(items: Mask) -> tuple[Mask, Mask]:
    """The first fifth of the items, and the others."""
    places = np.flatnonzero(items)
    learnt = np.zeros_like(items)
    learnt[places[: max(1, round(_LEARNT_SHARE * places.size))]] = True
    return learnt, items & ~learnt


def _values_for(fitter: SensorFitter, structure: SensorStructure, run: int, learnt: Mask) -> Values:
    return fitter.learn_run(structure, run, learnt) if learnt.any() else structure.values


def _is_run_bound(name: str) -> bool:
    return "@" in name


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2))) if values.size else float("nan")
