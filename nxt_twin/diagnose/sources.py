"""Which equation fails: free an extra variance in each and see which makes the readings likeliest.

After Kristensen, Madsen and Jørgensen (2004): where a model lacks something, the equation that lacks it asks for
noise. The hypotheses compete on the same deviations of the readings from the re-fitted baseline, under the noise
that a complete model would have; no effect of the library takes part, so this also speaks where none is known.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import final

import numpy as np

from nxt_twin.diagnose.diagnosis import Equation, Source, SourceFinding
from nxt_twin.diagnose.kalman import Randomness, cost, deviation, quiet
from nxt_twin.diagnose.linear import Linear
from nxt_twin.diagnose.noise import reading_floor
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Job, Simulator
from nxt_twin.recording.recording import FloatArray

SOURCE_OF: dict[Equation, Source] = {
    "torque_balance": "actuator",
    "electrical": "battery",
    "kinematic": "transmission",
    "measurement": "encoder",
    "timing": "clock_or_link",
}
_EQUATION_OF = {source: equation for equation, source in SOURCE_OF.items()}

_COMPLETE_TORQUE = (
    3e-3  # the unknown torque that a complete model leaves at most, as a share of an ordinary one
)
_ABOVE_FLOOR = 1.5
_SPAN = 1e8
_COARSE, _FINE = 10, 5
_SHIFTS_S = (4e-3, 0.015, 0.05)


@final
@dataclass(frozen=True)
class _Heard:
    """One job's deviations and what the plant was doing, shape (samples,)."""

    job: Job
    deviations: FloatArray
    drive: FloatArray
    speed: FloatArray
    acceleration: FloatArray


_Change = Callable[[_Heard, Randomness], Randomness]
_Freed = Callable[[float], _Change]


def sources(simulator: Simulator, linear: Linear, torque: float) -> tuple[SourceFinding, ...]:
    """Strengths of all hypotheses, the strongest first.

    Args:
        simulator: runs the plant.
        linear: the re-fitted baseline under the noise that the best structure leaves.
        torque: one that is ordinary for the plant, N·m or N.
    """
    plant, noise, jobs = linear.structure.plant, linear.structure.noise, linear.jobs
    inertia = plant.values[Slot(BASE_OWNER, "inertia")]
    heard = [_listen(simulator, plant, job, noise) for job in jobs]
    floor = reading_floor([job.signals for job in jobs])
    sober = replace(
        noise,
        reading_std=min(noise.reading_std, _ABOVE_FLOOR * floor) if floor > 0.0 else noise.reading_std,
        disturbance_std=min(noise.disturbance_std, _COMPLETE_TORQUE * torque / inertia),
    )
    complete = _total(heard, sober, lambda _, randomness: randomness)
    push, blur = (_COMPLETE_TORQUE * torque / inertia) ** 2, max(sober.reading_std, 1e-12) ** 2
    drive, speed, acceleration = (
        _mean_square([getattr(one, name) for one in heard]) for name in ("drive", "speed", "acceleration")
    )
    hypotheses: list[tuple[Source, float, _Freed]] = [
        ("actuator", push, lambda x: lambda _, r: replace(r, torque=r.torque + x)),
        ("battery", push, lambda x: lambda h, r: replace(r, torque=r.torque + x * h.drive**2 / drive)),
        (
            "battery",
            push,
            lambda x: lambda h, r: replace(r, torque=r.torque + x * h.acceleration**2 / acceleration),
        ),
        (
            "transmission",
            blur,
            lambda x: (
                lambda h, r: replace(r, slip_per_s=r.slip_per_s + x * np.abs(h.speed) / math.sqrt(speed))
            ),
        ),
        ("encoder", blur, lambda x: lambda _, r: replace(r, reading=r.reading + x)),
        (
            "clock_or_link",
            blur,
            lambda x: lambda h, r: replace(r, reading=r.reading + x * h.speed**2 / speed),
        ),
    ]
    strengths: dict[Source, float] = {"clock_or_link": _shift_nats(simulator, linear)}
    for source, scale, freed in hypotheses:
        least = _least(partial(_freed_total, heard, sober, freed), scale)
        strengths[source] = max(strengths.get(source, 0.0), complete - least)
    found = [
        SourceFinding(source, _EQUATION_OF[source], max(nats, 0.0), _p_value(nats))
        for source, nats in strengths.items()
    ]
    return tuple(sorted(found, key=lambda finding: -finding.strength))


def _p_value(nats: float) -> float:
    """Of a likelihood ratio for a variance that cannot be negative: half a chi-square of one degree of freedom."""
    return 0.5 * math.erfc(math.sqrt(max(nats, 0.0)))


def _listen(simulator: Simulator, plant: Plant, job: Job, noise: Noise) -> _Heard:
    trace = simulator.trace(plant, job)
    times_s = np.maximum.accumulate(job.signals.time_s + 1e-9 * np.arange(job.signals.time_s.size))
    return _Heard(
        job=job,
        deviations=deviation(job, trace["predicted"], noise),
        drive=trace["drive_torque"],
        speed=trace["speed"],
        acceleration=np.gradient(trace["speed"], times_s),
    )


def _total(heard: Sequence[_Heard], noise: Noise, freed: _Change) -> float:
    return sum(cost(one.job, one.deviations, noise, freed(one, quiet(one.job, noise))) for one in heard)


def _freed_total(heard: Sequence[_Heard], noise: Noise, freed: _Freed, size: float) -> float:
    return _total(heard, noise, freed(size))


def _shift_nats(simulator: Simulator, linear: Linear) -> float:
    """What the best common shift of all commands in time gains, beyond what the re-fit takes up of it."""
    values, active = linear.structure.plant.vectors()
    jobs = [
        replace(job, signals=replace(job.signals, command_time_s=job.signals.command_time_s + shift_s))
        for shift_s in _SHIFTS_S
        for job in linear.jobs
    ]
    results = simulator.run(values[None], active[None], jobs)
    count = len(linear.jobs)
    gains = []
    for first in range(0, len(jobs), count):
        moved = linear.whitened(results[first : first + count])[0]
        left = linear.left_of(moved)[0]
        gains.append(0.5 * float(left @ linear.innovations) ** 2 / max(float(moved @ left), 1e-12))
    return max(gains)


def _least(value: Callable[[float], float], scale: float) -> float:
    """The least value over sizes within `_SPAN` of `scale`, by a coarse and three finer grids in logarithms."""
    low, high, least = scale / 10.0, scale * _SPAN, math.inf
    for count in (_COARSE, _FINE, _FINE, _FINE):
        sizes = np.geomspace(low, high, count)
        values = [value(float(size)) for size in sizes]
        best = int(np.argmin(values))
        least = min(least, values[best])
        low, high = sizes[max(best - 1, 0)], sizes[min(best + 1, count - 1)]
    return least


def _mean_square(arrays: Sequence[FloatArray]) -> float:
    return max(float(np.mean(np.concatenate(arrays) ** 2)), 1e-300)
