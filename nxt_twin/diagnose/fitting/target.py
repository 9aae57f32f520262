"""The readings that a plant has to predict, and what a prediction of them costs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.fitting import losses
from nxt_twin.diagnose.fitting.batch import batches, samples_of
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Job, Result, Simulator


@final
@dataclass(frozen=True)
class Target:
    """The readings to fit.

    Attributes:
        jobs: the recordings; one recording may come several times, thinned in different ways or simulated.
        counted: which samples of each count, shape (samples,).
        check: which samples of each only judge a choice, shape (samples,).
        evidence: what one reading of each job is worth, less than 1 where readings tell of one another.
        corrected: which samples correct the run, shape (samples,); None where all do. Predictions between
            them are simulation.
        lenient: whether readings that are far off count softly.
        pull: how many times its evidence a job counts for while parameters are sought, so that they simulate.
    """

    jobs: tuple[Job, ...]
    counted: tuple[BoolArray, ...]
    check: tuple[BoolArray, ...]
    evidence: tuple[float, ...]
    corrected: tuple[BoolArray | None, ...]
    pull: tuple[float, ...]
    lenient: bool = False

    def beside(self, other: Target) -> Target:
        """Both targets as one."""
        return Target(
            self.jobs + other.jobs,
            self.counted + other.counted,
            self.check + other.check,
            self.evidence + other.evidence,
            self.corrected + other.corrected,
            self.pull + other.pull,
        )

    def checking(self) -> Target:
        """The readings that only judge a choice, in the place of those that are fitted.

        One that is far off counts softly: a glitch says little of a choice.
        """
        return replace(self, counted=self.check, lenient=True)

    def everything(self) -> Target:
        """Fitted and checking readings together."""
        both = tuple(a | b for a, b in zip(self.counted, self.check, strict=True))
        return replace(self, counted=both)

    def predicting(self) -> Target:
        """The jobs that every reading corrects."""
        return self._some([n for n, mask in enumerate(self.corrected) if mask is None])

    def simulating(self) -> Target:
        """The jobs that run freely between spells of correction."""
        return self._some([n for n, mask in enumerate(self.corrected) if mask is not None])

    def telling(self) -> Target:
        """The jobs whose readings are evidence: all others would be run for nothing."""
        return self._some([n for n, worth in enumerate(self.evidence) if worth > 0.0])

    def only(self, name: str) -> Target:
        """The jobs of the recording of that name."""
        return self._some([n for n, job in enumerate(self.jobs) if job.signals.name == name])

    def _some(self, rows: Sequence[int]) -> Target:
        return Target(
            tuple(self.jobs[n] for n in rows),
            tuple(self.counted[n] for n in rows),
            tuple(self.check[n] for n in rows),
            tuple(self.evidence[n] for n in rows),
            tuple(self.corrected[n] for n in rows),
            tuple(self.pull[n] for n in rows),
            self.lenient,
        )

    def pulling(self) -> Target:
        """With the evidence that counts while parameters are sought."""
        evidence = tuple(a * b for a, b in zip(self.evidence, self.pull, strict=True))
        return replace(self, evidence=evidence, pull=(1.0,) * len(self.pull))

    def counting_for_nothing(self) -> Target:
        """With readings that are run, but are no evidence."""
        return replace(self, evidence=(0.0,) * len(self.evidence))

    def errors(self, number: int, result: Result) -> FloatArray:
        """Errors of a job's predictions in standard deviations, shape (sets, samples)."""
        job = self.jobs[number]
        return np.asarray((job.signals.measured - result.predicted) / job.observer.innovation_std)

    def weight(self, number: int, result: Result) -> FloatArray:
        """What each reading of a job weighs in a step of a fit, shape (sets, samples)."""
        if self.corrected[number] is None:
            return result.weight
        z = self.errors(number, result)
        return np.asarray(1.0 / np.hypot(1.0, z / losses.SOFT))

    def costs(self, number: int, result: Result) -> FloatArray:
        """Negative log-likelihood of the counted readings of a job, nats, shape (sets,).

        Of simulated readings by a soft loss: a model on the edge of sticking is at times far off.
        """
        counted = self.counted[number]
        if self.corrected[number] is None and not self.lenient:
            return losses.summed(result.cost, counted)
        job = self.jobs[number]
        measured, std = job.signals.measured, job.observer.innovation_std
        if self.corrected[number] is None:
            return losses.lenient(result.cost, measured, result.predicted, std, counted)
        return losses.soft(measured, result.predicted, std, counted)

    def worth(self) -> int:
        """How many independent readings the counted ones are worth."""
        return int(sum(w * mask.sum() for w, mask in zip(self.evidence, self.seen(), strict=True)))

    def with_step(self, step_s: float) -> Target:
        """The readings, simulated with steps of `step_s`."""
        return replace(self, jobs=tuple(replace(job, step_s=step_s) for job in self.jobs))

    def seen(self) -> tuple[BoolArray, ...]:
        """Those of the counted samples that carry a reading which no start was taken from."""
        return tuple(
            mask & np.isfinite(job.signals.measured) & ~job.start.at
            for job, mask in zip(self.jobs, self.counted, strict=True)
        )

    def cost(self, results: Sequence[Result]) -> FloatArray:
        """Negative log-likelihood of the counted readings for each parameter set, nats."""
        parts = zip(results, self.evidence, strict=True)
        total = sum(worth * self.costs(n, result) for n, (result, worth) in enumerate(parts))
        return np.asarray(np.nan_to_num(total, nan=np.inf), dtype=np.float64)

    def costs_of(self, simulator: Simulator, plants: Sequence[Plant]) -> FloatArray:
        """Negative log-likelihood of the counted readings for each of `plants`, nats, run a few at a time."""
        values, active = (np.array(part) for part in zip(*(plant.vectors() for plant in plants), strict=True))
        own = self.telling()
        parts = batches(len(values), samples_of(own.jobs))
        return np.concatenate([own.cost(simulator.run(values[n], active[n], own.jobs)) for n in parts])
