"""Losses of readings, summed over those that count: compiled, since a fit asks for little else between its runs."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from nxt_twin.arrays import BoolArray, FloatArray

SOFT = 2.0
"""Standard deviations of a simulated reading from which its loss grows linearly."""

_LENIENT = 4.0  # likewise of a reading that only checks
_HALF_LOG_2PI = 0.5 * math.log(2.0 * math.pi)


def summed(cost: FloatArray, counted: BoolArray) -> FloatArray:
    """The `cost` of each set, shape (sets, samples), over the samples that are `counted`: shape (sets,)."""
    return np.asarray(_summed(cost, counted))


def soft(measured: FloatArray, predicted: FloatArray, std: FloatArray, counted: BoolArray) -> FloatArray:
    """Negative log-likelihood of counted readings by a soft loss, nats, shape (sets,).

    A model on the edge of sticking is at times far off.

    Args:
        measured: the readings, shape (samples,).
        predicted: what each set predicts, shape (sets, samples).
        std: standard deviation of each reading's error, shape (samples,).
        counted: which readings count, shape (samples,).
    """
    return np.asarray(_soft(measured, predicted, std, counted, SOFT))


def lenient(
    cost: FloatArray, measured: FloatArray, predicted: FloatArray, std: FloatArray, counted: BoolArray
) -> FloatArray:
    """As `soft` of readings that only check, or as `summed` by their own `cost` where this is less."""
    return np.asarray(_lenient(cost, measured, predicted, std, counted))


@njit(cache=True, nogil=True)
def _summed(cost, counted):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202  # compiled: numba infers the types
    found = np.zeros(cost.shape[0])
    for n in range(cost.shape[0]):
        for k in range(counted.shape[0]):
            if counted[k]:
                found[n] += cost[n, k]
    return found


@njit(nogil=True)
def _rising(z, from_std):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """The loss of a reading that is `z` standard deviations off: z²/2, and linear beyond `from_std`."""
    return from_std**2 * (math.hypot(1.0, z / from_std) - 1.0)


@njit(cache=True, nogil=True)
def _soft(measured, predicted, std, counted, from_std):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    found = np.zeros(predicted.shape[0])
    logs = 0.0
    for k in range(counted.shape[0]):
        if counted[k]:
            logs += math.log(std[k])
    for n in range(predicted.shape[0]):
        found[n] = logs
        for k in range(counted.shape[0]):
            if counted[k]:
                found[n] += _rising((measured[k] - predicted[n, k]) / std[k], from_std)
    return found


@njit(cache=True, nogil=True)
def _lenient(cost, measured, predicted, std, counted):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    found = np.zeros(predicted.shape[0])
    for k in range(counted.shape[0]):
        if counted[k]:
            least = _HALF_LOG_2PI + math.log(std[k])
            for n in range(predicted.shape[0]):
                far = least + _rising((measured[k] - predicted[n, k]) / std[k], _LENIENT)
                found[n] += cost[n, k] if not far < cost[n, k] else far
    return found
