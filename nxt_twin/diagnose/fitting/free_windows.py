"""A plant fitted to windows that run freely from smoothed readings: what a plain least-squares fit would do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from nxt_twin.diagnose.fitting.fit import fit
from nxt_twin.diagnose.fitting.fitter import SETTLED, Fitter
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.target import Target
from nxt_twin.diagnose.fitting.variables import variables_of
from nxt_twin.physics.observer import free
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import free_job
from nxt_twin.physics.start import restarts

_WIDER = 5.0  # priors: what windows show may lie far from the given numbers
_ITERATIONS = 25  # of a plain fit, at most
_LEAST_STD = 1e-12  # of a plant that simulates exactly, SI: an error is divided by it


def fitted_freely(fitter: Fitter, plant: Plant, error: float) -> Plant:
    """Fit `plant` to all windows of simulation that are not held out, nearly without priors.

    No noise is fitted, and no observer corrects a run, so nothing can take the place of missing physics.

    Args:
        fitter: of the problem.
        plant: where the fit begins.
        error: of a simulation, SI, that is ordinary; the loss grows linearly beyond twice that.
    """
    variables = variables_of(plant, fitter.problem.plant, fitter.problem.scale)
    wide = tuple(replace(variable, spread=_WIDER * variable.spread) for variable in variables)
    target = _free_windows(fitter.problem, max(error, _LEAST_STD), SETTLED.step_for(plant))
    fitted, _ = fit(
        fitter.simulator,
        plant,
        wide,
        target,
        iterations=_ITERATIONS,
        patience_nats=SETTLED.patience_nats,
        covariance=False,
    )
    return fitted.plant


def _free_windows(problem: Problem, error: float, step_s: float) -> Target:
    """All readings that are not held out, in windows that start from smoothed ones."""
    held = {id(part.signals): part.counted for part in problem.held_out}
    jobs, counted, begins = [], [], []
    for signals in problem.signals:
        start = restarts(signals, problem.window_s)
        jobs.append(replace(free_job(signals, start), observer=free(signals, error), step_s=step_s))
        kept = ~held.get(id(signals), np.zeros(start.at.size, dtype=bool))
        counted.append(np.asarray(np.isfinite(signals.measured) & kept))
        begins.append(start.at)
    size = len(jobs)
    unchecked = tuple(np.zeros_like(mask) for mask in counted)
    return Target(tuple(jobs), tuple(counted), unchecked, (1.0,) * size, tuple(begins), (1.0,) * size)
