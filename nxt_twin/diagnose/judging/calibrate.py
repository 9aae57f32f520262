"""How often noise alone would be taken for missing physics in just these recordings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.fitting.batch import batches
from nxt_twin.diagnose.fitting.kalman import clean_innovations
from nxt_twin.diagnose.fitting.linear import Linear, Trial, signatures
from nxt_twin.diagnose.search.limits import LIMITS
from nxt_twin.physics.simulate import Simulator

_REPLICATES = 200  # synthetic clean cases at most
_FEWEST = 20  # synthetic clean cases at least, however long the recordings are
_MOST_CELLS = 4_000_000  # cases times readings, which bounds the memory of an hour's recording
_SIGMAS = 3.0  # standard deviations by which the limit of a leftover exceeds the mean of clean cases


@final
@dataclass(frozen=True)
class FalseAlarms:
    """The result of the search on synthetic clean recordings with these inputs, stamps, quantum and noise.

    Attributes:
        alarms: of the synthetic cases, how many would have had an effect named in them.
        of: the number of synthetic cases.
    """

    alarms: int
    of: int

    @property
    def rate(self) -> float:
        """The share of alarms."""
        return self.alarms / max(self.of, 1)

    @property
    def upper_95(self) -> float:
        """The rate that is not exceeded with 95 % confidence (Wilson's score bound)."""
        z2, share = 1.645**2, self.rate
        spread = math.sqrt(1.645**2 * (share * (1.0 - share) / self.of + z2 / (4.0 * self.of**2)))
        return (share + z2 / (2.0 * self.of) + spread) / (1.0 + z2 / self.of)


def clean_cases(linear: Linear, rng: Generator) -> FloatArray:
    """Innovations of synthetic clean cases, as those of `linear`, shape (cases, readings)."""
    count = int(np.clip(_MOST_CELLS // max(linear.innovations.size, 1), _FEWEST, _REPLICATES))
    parts = []
    for job, predicted, gain, mask in zip(
        linear.jobs, linear.predicted, linear.gain, linear.counted, strict=True
    ):
        innovations = clean_innovations(job, predicted, linear.structure.noise, count, rng)
        part = innovations[:, mask]
        part *= (gain * job.observer.innovation_std)[mask]
        parts.append(part)
    return np.concatenate(parts, axis=1)


def alarms(simulator: Simulator, linear: Linear, trials: Sequence[Trial], clean: FloatArray) -> BoolArray:
    """In which of the clean cases an effect would be named, shape (cases,)."""
    return null_gains(simulator, linear, trials, clean) > LIMITS.gain_nats


def null_gains(
    simulator: Simulator, linear: Linear, trials: Sequence[Trial], clean: FloatArray
) -> FloatArray:
    """The largest gain of an effect on each of the clean cases, less its penalty, nats, shape (cases,).

    Each trial's signature is scaled to fit a clean case's fitted readings best (a score test with the re-fit
    projected out). A gain that check readings do not bear out counts as none (-inf).
    """
    fitted = ~linear.checks
    innovations = linear.left_of(clean, fitted)
    seen, unseen = innovations[:, fitted], innovations[:, ~fitted]
    del innovations  # of an hour, each copy is 60 MB
    largest = np.full(len(clean), -np.inf)
    readings = math.log(max(int(fitted.sum()), 2))
    for part in batches(len(trials), linear.innovations.size):
        found = signatures(simulator, linear, linear.structure.plant, trials[part])
        left = linear.left_of(found, fitted)
        strength = np.maximum(np.sum(found[:, fitted] * left[:, fitted], axis=1), 1e-12)
        share = seen @ found[:, fitted].T / strength
        check = share * (unseen @ left[:, ~fitted].T)
        check -= 0.5 * share**2 * np.sum(left[:, ~fitted] ** 2, axis=1)
        further = [max(len(t.effect.parameters) - len(t.effect.supersedes), 1) for t in trials[part]]
        gain = 0.5 * share**2 * strength - 0.5 * readings * np.array(further)
        borne_out = np.where(check > LIMITS.check_nats, gain, -np.inf)
        largest = np.maximum(largest, borne_out.max(axis=1, initial=-np.inf))
    return largest


def leftover_threshold(clean_nats: FloatArray, least: float) -> float:
    """The largest leftover of synthetic clean cases, or mean plus some standard deviations; at least `least`."""
    spread = float(np.mean(clean_nats) + _SIGMAS * np.std(clean_nats))
    return max(least, float(np.max(clean_nats)), spread)
