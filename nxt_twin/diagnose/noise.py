"""How noisy recordings are under a plant: the readings, and an unknown torque that no model will explain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import minimize

from nxt_twin.diagnose.fit import Target
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.observer import Noise, observer
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Simulator
from nxt_twin.physics.smooth import smoothed
from nxt_twin.recording.recording import FloatArray

DISTURBANCE_TIME_S = 0.15
_SMALLEST_DISTURBANCE = 1e-4
_SIMPLEX = np.array([[0.0, 0.0], [0.7, 0.0], [0.0, -1.4]])  # first steps of the search, in logarithms
_SEARCH = {"xatol": 0.1, "fatol": 0.3, "maxfev": 40}


def first_guess(plant: Plant, signals: Sequence[Signals], torque: float) -> Noise:
    """Noise to start a search from; `torque` is one that is ordinary for the plant."""
    inertia = plant.values[Slot(BASE_OWNER, "inertia")]
    rough = np.sqrt(np.mean([np.nanmean((s.measured - _fitted(s)) ** 2) for s in signals]))
    floor = reading_floor(signals)
    return Noise(max(floor, float(rough)), 0.1 * torque / inertia, DISTURBANCE_TIME_S, damping_per_s(plant))


def reading_floor(signals: Sequence[Signals]) -> float:
    """The least standard deviation that the readings' quantum allows."""
    quantum = max(s.quantum for s in signals)
    return float(quantum / np.sqrt(12.0))


def damping_per_s(plant: Plant) -> float:
    """How fast the plant forgets its speed: (Kt·Ke/R + B)/J."""
    values = {slot.symbol: value for slot, value in plant.values.items() if slot.owner == BASE_OWNER}
    damping = plant.values.get(Slot("viscous_friction", "viscous"), 0.0)
    if "torque_constant" in values:
        damping += values["torque_constant"] * values["back_emf"] / values["resistance"]
    return damping / values["inertia"]


def with_noise(target: Target, noise: Noise) -> Target:
    """The same readings, corrected by the gains that suit `noise`."""
    jobs = tuple(
        replace(job, observer=observer(job.signals, noise), disturbance_time_s=noise.disturbance_time_s)
        for job in target.jobs
    )
    return replace(target, jobs=jobs)


def estimate(simulator: Simulator, plant: Plant, target: Target, start: Noise) -> tuple[Noise, float]:
    """The likeliest noise under `plant`, searched from `start`, and its negative log-likelihood."""
    floor = reading_floor([job.signals for job in target.jobs])
    smallest = _SMALLEST_DISTURBANCE * start.disturbance_std
    damping = damping_per_s(plant)

    def noise_at(logs: FloatArray) -> Noise:
        reading, disturbance = np.exp(logs)
        return Noise(max(floor, reading), max(smallest, disturbance), start.disturbance_time_s, damping)

    start_logs = np.log([start.reading_std, start.disturbance_std])
    found = minimize(
        lambda logs: _cost(simulator, plant, target, noise_at(logs)),
        start_logs,
        method="Nelder-Mead",
        options={**_SEARCH, "initial_simplex": start_logs + _SIMPLEX},
    )
    return noise_at(found.x), float(found.fun)


def _cost(simulator: Simulator, plant: Plant, target: Target, noise: Noise) -> float:
    values, active = plant.vectors()
    tuned = with_noise(target, noise)
    return float(tuned.cost(simulator.run(values[None], active[None], tuned.jobs))[0])


def _fitted(signals: Signals) -> FloatArray:
    position, speed = smoothed(signals)
    return np.asarray(speed if signals.is_speed else position)
