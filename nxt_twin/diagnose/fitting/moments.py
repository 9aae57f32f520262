"""In which moments one structure gains over another."""

from __future__ import annotations

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.fitter import SETTLED, Fitter
from nxt_twin.diagnose.fitting.structure import Structure


def moments_gained(fitter: Fitter, simpler: Structure, richer: Structure) -> float:
    """In how many moments, of a second each, `richer` gains what it gains, were they all to gain alike."""
    each = _gained(fitter, simpler, richer)
    return float(np.sum(each) ** 2 / max(np.sum(each**2), 1e-12))


def gained_elsewhere(fitter: Fitter, simpler: Structure, richer: Structure) -> float:
    """What `richer` gains in all seconds but the one in which it gains most, nats."""
    each = _gained(fitter, simpler, richer)
    return float(np.sum(each) - np.max(each))


def _gained(fitter: Fitter, simpler: Structure, richer: Structure) -> FloatArray:
    """What `richer` gains in each second of each recording, nats.

    Both under one noise, that of `simpler`: a noise that one moment forced upon a model costs it all the others. Where
    `richer` doubts readings, it is that of `richer`: in the other these readings hide, however many there are.
    """
    noise = richer.noise if _doubts_more(simpler, richer) else simpler.noise
    tuned = fitter.tuned(noise, SETTLED.step_for(richer.plant)).predicting()
    gains: dict[tuple[str, int], float] = {}
    for sign, structure in ((1.0, simpler), (-1.0, richer)):
        values, active = structure.plant.vectors()
        results = fitter.simulator.run(values[None], active[None], tuned.jobs)
        for job, result in zip(tuned.jobs, results, strict=True):
            seconds = np.floor(job.signals.time_s - job.signals.time_s[0]).astype(int)
            for second, cost in enumerate(np.bincount(seconds, np.nan_to_num(result.cost[0]))):
                key = (job.signals.name, second)
                gains[key] = gains.get(key, 0.0) + sign * float(cost)
    return np.array(list(gains.values()))


def _doubts_more(simpler: Structure, richer: Structure) -> bool:
    """Whether `richer` has a fault that makes readings doubtful, and `simpler` has none."""
    doubting, trusting = (
        any("outlier" in effect.terms for effect in structure.plant.effects)
        for structure in (richer, simpler)
    )
    return doubting and not trusting
