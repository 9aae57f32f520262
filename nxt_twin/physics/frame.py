"""What every kernel does, whatever effects it holds: plain functions that the assembled source calls, compiled.

Numbers are floats and arrays are contiguous; the functions hold nothing that numba does not compile.
"""

from __future__ import annotations

import math

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray

_SQRT_TAU = math.sqrt(2.0 * math.pi)

CommandArrays = tuple[FloatArray, FloatArray, IntArray, FloatArray]
"""Times (s), values, drive modes and supply voltages (V) of the commands, shape (commands,) each."""

Others = tuple[FloatArray, FloatArray]
"""Times (s), shape (loads,), from which the other motors load the supply so, shape (loads, 2)."""

StepClock = tuple[float, float, float, float]
"""Delay of the commands (s), the clock's pace, the longest step (s), and the leak of the unknown torque (1/s)."""

Spans = tuple[FloatArray, IntArray, IntArray]
"""Pieces of time in which nothing changes but the state, filled by `schedule`.

Shape (spans, 8): length of a step by the stamps and by the plant (s), what is left of the unknown torque after a step,
time since the first row (s), command (NaN before the first acts), supply (V), load and speed of the other motors. Shape
(spans, 2): steps, drive mode. Shape (rows + 1,): the first span of each row.
"""


def room(time_s: FloatArray, command_time_s: FloatArray, others_time_s: FloatArray) -> Spans:
    """Where `schedule` may put the spans between rows at `time_s`: one for each row, command and load."""
    rows = time_s.shape[0]
    most = rows + command_time_s.shape[0] + others_time_s.shape[0]
    return np.empty((most, 8)), np.empty((most, 2), np.int64), np.empty(rows + 1, np.int64)


def schedule(
    target_s: FloatArray, commands: CommandArrays, others: Others, clock: StepClock, into: Spans
) -> None:
    """Part the time between rows where a command or another motor's load changes, and into steps.

    Args:
        target_s: when each row was taken, shape (rows,).
        commands: what the plant is told.
        others: what the other motors do.
        clock: how times go together.
        into: where the spans go; room for one for each row, command and load.
    """
    command_time_s, command, command_mode, command_supply_v = commands
    others_time_s, others_load = others
    delay_s, pace, step_max_s, leak_per_s = clock
    span, steps, first = into
    t = began_s = target_s[0]
    j = m = -1
    n = 0
    for k in range(target_s.shape[0]):
        first[k] = n
        while t < target_s[k]:
            j = latest(command_time_s, j, delay_s, t)
            m = latest(others_time_s, m, delay_s, t)
            stop = next_change(command_time_s, j, delay_s, target_s[k])
            stop = next_change(others_time_s, m, delay_s, stop)
            pieces = max(1, math.ceil((stop - t) / step_max_s - 1e-9))
            piece_s = (stop - t) / pieces
            span[n, 0] = piece_s
            span[n, 1] = piece_s / pace
            span[n, 2] = math.exp(-piece_s / pace * leak_per_s)
            span[n, 3] = t - began_s
            span[n, 4] = command[j] if j >= 0 else math.nan
            span[n, 5] = command_supply_v[max(j, 0)]
            span[n, 6] = others_load[m, 0] if m >= 0 else 0.0
            span[n, 7] = others_load[m, 1] if m >= 0 else 0.0
            steps[n, 0] = pieces
            steps[n, 1] = command_mode[max(j, 0)]
            n += 1
            t = stop
    first[target_s.shape[0]] = n


def latest(time_s: FloatArray, before: int, delay_s: float, t: float) -> int:
    """The last of `time_s` (s, rising), `delay_s` later, that is not after `t`; `before` is one that is not."""
    found = before
    while found + 1 < time_s.shape[0] and time_s[found + 1] + delay_s <= t:
        found += 1
    return found


def next_change(time_s: FloatArray, held: int, delay_s: float, stop: float) -> float:
    """When what follows the `held` one acts (s), or `stop` where that is sooner."""
    if held + 1 < time_s.shape[0] and time_s[held + 1] + delay_s < stop:
        return float(time_s[held + 1] + delay_s)
    return stop


def log_scales(reading_std: FloatArray) -> FloatArray:
    """The logarithm of a normal density's scale for each innovation's deviation; 0 where that is 0."""
    found = np.zeros(reading_std.shape)
    for v in range(reading_std.shape[0]):
        for k in range(reading_std.shape[1]):
            if reading_std[v, k] > 0.0:
                found[v, k] = math.log(reading_std[v, k] * _SQRT_TAU)
    return found


def anywhere(flags: BoolArray) -> BoolArray:
    """In which columns any flag is set."""
    found = np.zeros(flags.shape[1], np.bool_)
    for v in range(flags.shape[0]):
        found |= flags[v]
    return found


def same(one: FloatArray, other: FloatArray) -> bool:
    """Whether two arrays of one shape hold equal numbers."""
    return bool(np.all(one == other))


def probes(rows: FloatArray) -> FloatArray:
    """The first of the stamps, or of their rows, and some evenly spaced ones after it, up to 16."""
    return rows[:: max(rows.shape[0] // 8, 1)].copy()


def free_speed(kept: float, before: float, pull: float, inverse: float) -> float:
    """The speed at a step's end were there no dry friction, by the trapezoidal rule.

    Args:
        kept: twice the inertia over the step, less the torque that is lost for each unit of speed.
        before: speed at the step's beginning.
        pull: torque that does not depend on speed.
        inverse: of twice the inertia over the step, plus that torque.
    """
    return (kept * before + 2.0 * pull) * inverse


def slowed(before: float, free: float, direction: float, bite: float) -> float:
    """The speed at a step's end with dry friction, which takes `bite` of the `free` one, against `direction`.

    A plant that comes to rest within the step stays at rest or turns back, for what is left of the step.
    """
    after = free - direction * bite
    if after * direction < 0.0:
        push = direction * (before - free) - bite
        rest = 1.0 - direction * before / (push + 2.0 * bite)
        after = -direction * push * rest if push > 0.0 else 0.0
    return after


def scattered(std: float, log_scale: float, scatter: float) -> tuple[float, float, float]:
    """How far a reading with `scatter` added to its variance is trusted; its deviation and log scale then."""
    trust = std * std / (std * std + scatter)
    return trust, std / math.sqrt(trust), log_scale - 0.5 * math.log(trust)


def believed(ratio: float, log_scale: float, share: float, outlier: float) -> tuple[float, float]:
    """The probability that a reading is none of the faults, and its negative log-likelihood, nats.

    Args:
        ratio: the innovation over its deviation.
        log_scale: of the normal density.
        share: of the readings that are no faults.
        outlier: density of the faults at this reading.
    """
    density = share * math.exp(-0.5 * ratio * ratio - log_scale)
    total = density + outlier + 1e-300
    return density / total, -math.log(total)
