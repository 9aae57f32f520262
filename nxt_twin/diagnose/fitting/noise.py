"""How noisy recordings are under a plant: the readings, and an unknown torque that no model will explain."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.fitting.batch import batches, samples_of
from nxt_twin.diagnose.fitting.losses import SOFT
from nxt_twin.diagnose.fitting.tamed import tamed
from nxt_twin.diagnose.fitting.target import Target
from nxt_twin.physics.base.dc_motor import DC_MOTOR
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.observer import Noise, Observer, observer
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Simulator
from nxt_twin.physics.smooth import smoothed

DISTURBANCE_TIME_S = (
    0.15  # over which an unknown torque forgets itself; one that never does takes up slow physics
)
LOST = Slot("missed_counts", "loss")
_SMALLEST = 1e-4  # of a first guess: no noise is searched below
_STAR = np.array([[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 1.0]])
_WIDEST_STAR = 0.7  # in logarithms
_NARROWER_STAR = 0.25  # as `_WIDEST_STAR`, where a noise is known to be near
_MOST_STARS = 8  # of one estimate
_SHRINKING = 0.5  # of a star's arms where its centre is lowest
_FINEST_STAR = 0.1  # arms at which an estimate may rest
_LONGEST_STEP = 3.0  # in arms of the star
_WILD_NATS = 1e100  # of a run that ran away: no paraboloid goes through it
_FLAT_NATS = 1e-3  # bend below which a slope alone says which way
_LEVEL_NATS = 5.0  # least fall of a star's arm along the reading noise, where that makes a difference
_LOUDER = np.log([[10.0, 1.0], [100.0, 1.0], [1000.0, 1.0], [10.0, 0.1], [100.0, 0.1], [1000.0, 0.1]])
"""Times both deviations, looked at where a reading's is next to nothing: no slope leads back from there.

A poor plant asks for an unknown torque beside which no reading seems noisy. A better one begins with that noise."""
_RESTING_NATS = 0.2  # an estimate rests where the next star promises less
_SAME_DAMPING = 0.1  # relative change of a plant's damping that changes no gains
_WORSE_NATS = 100.0  # by which a plant's own damping may be less likely: a fit will make up for it
_LARGEST_DRIFT = 1e4  # either way: keeps standard deviations finite
_LEAST_SQUARE = 1e-12  # of scaled errors: keeps the drift above 0
_DRIFT_ROUNDS = 30  # of its fixed point, at most
_DRIFT_FOUND = 1e-6  # relative change at which they end


def first_noise(plant: Plant, signals: Sequence[Signals], torque: float) -> Noise:
    """Noise to start a search from; `torque` is one that is ordinary for the plant."""
    inertia = plant.values[Slot(BASE_OWNER, "inertia")]
    reading_std = max(reading_floor(signals), roughness(signals))
    return Noise(reading_std, 0.1 * torque / inertia, DISTURBANCE_TIME_S, damping_per_s(plant))


def roughness(signals: Sequence[Signals]) -> float:
    """How far readings lie off a smooth curve through them, RMS, SI: their noise, and that of their stamps."""
    return float(np.sqrt(np.mean([np.nanmean((s.measured - _fitted(s)) ** 2) for s in signals])))


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


def lag_of(plant: Plant) -> float:
    """The time constant of a motor's speed, s; 0 of what follows goals or forces, whose speed may be any function."""
    driven_by_duty = plant.layout.base.kind == DC_MOTOR.kind
    return 1.0 / damping_per_s(plant) if driven_by_duty else 0.0


def with_noise(target: Target, noise: Noise) -> Target:
    """The same readings, corrected by the gains that suit `noise`."""
    jobs = tuple(
        replace(
            job, observer=_observer(job.signals, noise, mask), disturbance_time_s=noise.disturbance_time_s
        )
        for job, mask in zip(target.jobs, target.corrected, strict=True)
    )
    return replace(target, jobs=jobs)


def _observer(signals: Signals, noise: Noise, corrected: BoolArray | None) -> Observer:
    if corrected is None:
        return observer(signals, noise)
    free = observer(signals, noise, corrected)
    gains = free.gains.copy()
    gains[:, 2] = 0.0  # an unknown torque is no part of a simulation
    return Observer(gains, noise.drift * free.innovation_std)


def drift_of(simulator: Simulator, plant: Plant, target: Target, noise: Noise) -> float:
    """How far simulated readings are off, over what `noise` makes of single ones: the likeliest factor."""
    tuned = with_noise(target.simulating(), replace(noise, drift=1.0))
    values, active = plant.vectors()
    results = simulator.run(values[None], active[None], tuned.jobs)
    z = [
        tuned.errors(n, result)[0, mask]
        for n, (result, mask) in enumerate(zip(results, tuned.seen(), strict=True))
    ]
    square = tamed(np.nan_to_num(np.concatenate(z), nan=_WILD_NATS)) ** 2 if z else np.zeros(0)
    if not square.size:
        return 1.0
    drift2 = max(float(np.median(square)), _LEAST_SQUARE)
    for _ in range(_DRIFT_ROUNDS):
        scaled = square / drift2
        larger = float(np.mean(scaled / np.sqrt(1.0 + scaled / SOFT**2)))
        drift2 = max(drift2 * larger, _LEAST_SQUARE)  # a motor that is held fast leaves no error at all
        if abs(larger - 1.0) < _DRIFT_FOUND:
            break
    return float(np.clip(math.sqrt(drift2), 1.0 / _LARGEST_DRIFT, _LARGEST_DRIFT))


def estimate(
    simulator: Simulator, plant: Plant, target: Target, start: Noise, *, near: bool = False
) -> tuple[Noise, float]:
    """The likeliest noise under `plant`, searched from `start`, and how much likelier than that it is, nats.

    A start that is `near` already gets a narrower search. An encoder may lose counts one by one as if by dice: what
    that adds is taken where it is likelier.
    """
    whole, target = target, target.predicting()
    damping = _likelier_damping_per_s(simulator, plant, target, start)
    found = [
        _searched(simulator, plant, target, replace(start, damping_per_s=damping, slip=slip), near=near)
        for slip in _slips(plant, target)
    ]
    best, cost, _ = min(found, key=lambda one: one[1])
    return replace(best, drift=drift_of(simulator, plant, whole, best)), found[0][2] - cost


def _slips(plant: Plant, target: Target) -> tuple[float, ...]:
    """What positions may gain by themselves, as `Noise.slip`: nothing, and what counts that are lost at random make."""
    share = plant.values.get(LOST, 0.0)
    quantum = max(job.signals.quantum for job in target.jobs)
    return (0.0, share * (1.0 - share) * quantum) if share * quantum > 0.0 else (0.0,)


def _searched(
    simulator: Simulator, plant: Plant, target: Target, start: Noise, *, near: bool
) -> tuple[Noise, float, float]:
    """The likeliest deviations beside all else of `start`, their cost and that of `start`, nats.

    In the logarithms of both deviations, the log-likelihood is nearly a paraboloid. The search evaluates a
    star of points at once, moves its centre to the paraboloid's peak, and shrinks the star.
    """
    floor = reading_floor([job.signals for job in target.jobs])
    lowest = np.log([max(floor, _SMALLEST * start.reading_std), _SMALLEST * start.disturbance_std])

    def noise_at(logs: FloatArray) -> Noise:
        reading, disturbance = np.exp(np.maximum(logs, lowest))
        return replace(start, reading_std=float(reading), disturbance_std=float(disturbance))

    def costs_at(points: FloatArray) -> FloatArray:
        return _costs(simulator, plant, target, [noise_at(point) for point in points])

    centre = best = np.maximum(np.log([start.reading_std, start.disturbance_std]), lowest)
    cost = math.inf
    start_cost = math.inf
    reach = _NARROWER_STAR if near else _WIDEST_STAR
    for number in range(_MOST_STARS):
        points = np.maximum(centre + reach * _STAR, lowest)
        costs = costs_at(points)
        nearest = int(np.argmin(costs))
        if number == 0:
            start_cost = float(costs[0])
            louder = _likelier_louder(costs, centre, costs_at)
            if louder is not None:
                centre = louder
                continue
        if costs[nearest] < cost:
            best, cost = points[nearest], float(costs[nearest])
        step, promised = to_the_lowest(costs, held=(centre <= lowest) & (costs[1:5:2] >= costs[0]))
        if promised < _RESTING_NATS and (reach < _FINEST_STAR or step.any()):
            break
        centre = np.maximum(centre + reach * step if costs[0] <= cost + promised else best, lowest)
        if (
            np.abs(step).max() < 1.0
        ):  # also where the centre is lowest and the star was too wide to be a paraboloid
            reach *= _SHRINKING
    return noise_at(best), cost, start_cost


def _likelier_louder(
    costs: FloatArray, centre: FloatArray, costs_at: Callable[[FloatArray], FloatArray]
) -> FloatArray | None:
    """A point with larger reading noise that is likelier than `centre`, where the star of `costs` round that is level.

    None where the star tells what the reading noise is, or no such point is likelier.
    """
    if np.abs(costs[1:3] - costs[0]).max() > _LEVEL_NATS:
        return None
    points = centre + _LOUDER
    found = costs_at(points)
    return points[int(np.argmin(found))] if found.min() < costs[0] - _LEVEL_NATS else None


def _likelier_damping_per_s(simulator: Simulator, plant: Plant, target: Target, start: Noise) -> float:
    """How fast the plant forgets its speed, or what `start` says of it where that is out of the question.

    A plant whose current is held, or has yet to follow, forgets nothing like as fast as its equation at rest tells, and
    with gains that count on it a run may run away.
    """
    own = replace(start, damping_per_s=damping_per_s(plant))
    if abs(own.damping_per_s - start.damping_per_s) <= _SAME_DAMPING * own.damping_per_s:
        return own.damping_per_s
    costs = _costs(simulator, plant, target, [own, start])
    return (own if costs[0] < costs[1] + _WORSE_NATS else start).damping_per_s


def to_the_lowest(costs: FloatArray, held: BoolArray) -> tuple[FloatArray, float]:
    """The step, in arms of the star, to the lowest point of the paraboloid through it, and the fall to there.

    A deviation that is `held` stays: it lies at its least value and would go further down.
    """
    if not (np.abs(costs) < _WILD_NATS).all():  # nor where one is no number
        finite = np.where(np.isnan(costs), math.inf, costs)
        nearest = int(np.argmin(finite))
        fall = float(finite[0] - finite[nearest]) if np.isfinite(finite[nearest]) else 0.0
        return _LONGEST_STEP * _STAR[nearest], fall
    middle, right, left, up, down, corner = costs
    slope = np.where(held, 0.0, 0.5 * np.array([right - left, up - down]))
    twist = 0.0 if held.any() else corner - right - up + middle
    bends = np.where(held, 1.0, [right + left - 2.0 * middle, up + down - 2.0 * middle])
    curve = np.array([[bends[0], twist], [twist, bends[1]]])
    # Where the surface bends down or hardly at all, the slope still says which way, and the clipping how far.
    bend, axes = np.linalg.eigh(curve)
    stiffness = np.maximum(np.abs(bend), _FLAT_NATS)
    step = np.clip(-axes @ ((axes.T @ slope) / stiffness), -_LONGEST_STEP, _LONGEST_STEP)
    return step, float(-slope @ step - 0.5 * step @ (axes * stiffness) @ axes.T @ step)


def _costs(simulator: Simulator, plant: Plant, target: Target, noises: Sequence[Noise]) -> FloatArray:
    """The target's cost under each noise, as many as may be run at once."""
    values, active = plant.vectors()
    size = len(target.jobs)
    found: list[float] = []
    for part in batches(len(noises), samples_of(target.jobs)):
        tuned = [with_noise(target, noise) for noise in noises[part]]
        results = simulator.run(values[None], active[None], [job for one in tuned for job in one.jobs])
        found += [float(one.cost(results[n * size : (n + 1) * size])[0]) for n, one in enumerate(tuned)]
    return np.array(found)


def _fitted(signals: Signals) -> FloatArray:
    position, speed = smoothed(signals)
    return np.asarray(speed if signals.is_speed else position)
