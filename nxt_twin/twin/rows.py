"""Rows of a batch round an estimate: where they are put, and what is made of where they have got to.

Compiled, since it is done for every model at every reading.
"""

from __future__ import annotations

import math

from numba import njit

ANGLE, SPEED, TORQUE, NUMBER = range(4)
SHARED = 3
"""Angle, speed and torque are estimated by every model; some have a number of their own."""


@njit(cache=True, nogil=True)
def put(  # type: ignore[no-untyped-def]  # noqa: ANN201  # compiled: numba infers the types
    mean,  # noqa: ANN001
    covariance,  # noqa: ANN001
    least_spread,  # noqa: ANN001
    least_number,  # noqa: ANN001
    along,  # noqa: ANN001
    spread,  # noqa: ANN001
    state,  # noqa: ANN001
    torque,  # noqa: ANN001
    number,  # noqa: ANN001
):
    """Put the first row at the estimate, and two rows, one standard deviation each way, along some of its components.

    Args:
        mean: the estimate: angle (rad), speed (rad/s), torque (N·m) and perhaps a number, shape (n,).
        covariance: of it, shape (n, n).
        least_spread: distances of the neighbours that are not gone below, shape (n,).
        least_number: the number cannot be less.
        along: the components along which neighbours stand, shape (m,).
        spread: the distances of the neighbours, out, shape (n,).
        state: of the rows, shape (1 + 2 m, states); what is not estimated is as in the first row.
        torque: of the rows, N·m, shape (1 + 2 m,).
        number: of the rows, shape (1 + 2 m,); left alone where the estimate has none.
    """
    for i in range(mean.shape[0]):
        spread[i] = max(least_spread[i], math.sqrt(max(covariance[i, i], 0.0)))
    for row in range(state.shape[0]):
        state[row] = state[0]
        state[row, ANGLE], state[row, SPEED], torque[row] = mean[ANGLE], mean[SPEED], mean[TORQUE]
        if mean.shape[0] > SHARED:
            number[row] = max(mean[NUMBER], least_number)
    for n in range(along.shape[0]):
        i = along[n]
        for side in range(2):
            row = 1 + 2 * n + side
            value = mean[i] + (spread[i] if side == 0 else -spread[i])
            if i == TORQUE:
                torque[row] = value
            elif i == NUMBER:
                number[row] = max(value, least_number)
            else:
                state[row, i] = value


@njit(cache=True, nogil=True)
def taken(  # type: ignore[no-untyped-def]  # noqa: ANN201  # compiled: numba infers the types
    along,  # noqa: ANN001
    spread,  # noqa: ANN001
    state,  # noqa: ANN001
    torque,  # noqa: ANN001
    mean,  # noqa: ANN001
    transition,  # noqa: ANN001
):
    """Take where the rows have got to: the estimate, and by central differences how it depends on where it was.

    A component along which no neighbours stand moves all alike.

    Args:
        along: as `put` had it.
        spread: as `put` left it.
        state: of the rows.
        torque: of the rows, N·m.
        mean: where the estimate has got to, out.
        transition: the matrix of the differences, out, shape (n, n).
    """
    mean[ANGLE], mean[SPEED], mean[TORQUE] = state[0, ANGLE], state[0, SPEED], torque[0]
    transition[:, :] = 0.0
    for i in range(transition.shape[0]):
        transition[i, i] = 1.0
    for n in range(along.shape[0]):
        i, up, down = along[n], 1 + 2 * n, 2 + 2 * n
        apart = 2.0 * spread[i]
        transition[ANGLE, i] = (state[up, ANGLE] - state[down, ANGLE]) / apart
        transition[SPEED, i] = (state[up, SPEED] - state[down, SPEED]) / apart
        transition[TORQUE, i] = (torque[up] - torque[down]) / apart


@njit(cache=True, nogil=True)
def stirred(  # type: ignore[no-untyped-def]  # noqa: ANN201  # compiled: numba infers the types
    transition,  # noqa: ANN001
    fresh,  # noqa: ANN001
    angle_floor,  # noqa: ANN001
    speed_floor,  # noqa: ANN001
    process,  # noqa: ANN001
):
    """The covariance of what torque that arrives evenly over an interval does to the estimate.

    Args:
        transition: over the interval, shape (n, n).
        fresh: variance of the torque that arrived, N²·m².
        angle_floor: variance of the angle that is added anyway, rad².
        speed_floor: the same of the speed, rad²/s².
        process: the covariance, out, shape (n, n).
    """
    process[:, :] = 0.0
    angle, speed = transition[ANGLE, TORQUE], transition[SPEED, TORQUE]
    # As shares of what torque does that is there from the beginning: its effect on angle grows with the square of
    # the time it is there, on speed with the time.
    process[ANGLE, ANGLE] = fresh * angle * angle / 5.0 + angle_floor
    process[SPEED, SPEED] = fresh * speed * speed / 3.0 + speed_floor
    process[TORQUE, TORQUE] = fresh
    process[ANGLE, SPEED] = process[SPEED, ANGLE] = fresh * angle * speed / 4.0
    process[ANGLE, TORQUE] = process[TORQUE, ANGLE] = fresh * angle / 3.0
    process[SPEED, TORQUE] = process[TORQUE, SPEED] = fresh * speed / 2.0
