"""How sure the parameters are: covariance under innovations that are neither white nor of one size."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.linear import Linear, deviations, linearise
from nxt_twin.diagnose.fitting.noise import LOST, with_noise
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import SETTLED_STEP_S, step_for
from nxt_twin.physics.simulate import Simulator

BLOCK_S = 1.0  # s: the longest block of readings whose scores are summed before they are squared
_FEWEST_BLOCKS = 12  # blocks in all recordings together: short recordings are cut finer
_SUPPLY_DOUBT = 1.5e-3  # of the open-circuit supply: readings in steps of 14 mV, each with its own load
_SUPPLY_MOVE = 1e-3  # of the supply: the step that measures what a higher one does to the readings
FROZEN_DOUBT = 0.15  # of a given inductance
_FROZEN_MOVE = 0.05  # of a frozen parameter: the step that measures what a larger one does to the readings
_SLIP_STEP = 0.3  # of the scatter of lost counts, as a logarithm, over which its likelihood bends
_MODEL_DOUBT = 1.3  # what a wrong law of friction and the choice of effects add, from the development seeds
_ZERO_DOUBT = 1.0 / math.sqrt(
    3.0
)  # quanta: a count stands for some angle within a step of it, to either side


def covariance_of(simulator: Simulator, problem: Problem, linear: Linear) -> FloatArray:
    """Covariance of the variables of `linear`, SI, from the readings that set them.

    These are single steps, or windows of simulation where single steps are no evidence.
    """
    if not problem.by_windows:
        told = _told_by_chance(simulator, problem, linear, robust_covariance(simulator, linear))
    else:
        windows = linearise(simulator, problem, linear.structure, target=problem.simulated.everything())
        told = robust_covariance(simulator, windows, block_s=problem.window_s)
    return _at_bounds(problem, linear, told)


def _at_bounds(problem: Problem, linear: Linear, covariance: FloatArray) -> FloatArray:
    """`covariance` with the variables on a bound as known to all others: readings would have them further still.

    Each keeps its own doubt.
    """
    plant = linear.structure.plant
    for place, variable in enumerate(linear.variables):
        slot = variable.slots[0]
        parameter = plant.layout.parameters[slot].scaled(problem.scale)
        value, own = plant.values[slot] / parameter.si, covariance[place, place]
        if own > 0.0 and not parameter.lower < value < parameter.upper:
            along = covariance[place] / math.sqrt(own)
            covariance = covariance - np.outer(along, along)
            covariance[place, place] = own
    return covariance


def _told_by_chance(
    simulator: Simulator, problem: Problem, linear: Linear, covariance: FloatArray
) -> FloatArray:
    """`covariance` with what the scatter of counts that are lost by chance tells of their share.

    A motor that drives one way may lose a share of its counts, or have another torque constant. Only chance tells then.
    """
    structure = linear.structure
    place = next((n for n, variable in enumerate(linear.variables) if variable.slots[0] == LOST), None)
    if place is None or not structure.noise.slip:
        return covariance
    target = problem.everything().with_step(step_for(structure.plant, SETTLED_STEP_S))
    slips = structure.noise.slip * np.exp(_SLIP_STEP * np.array([-1.0, 0.0, 1.0]))
    noises = [replace(structure.noise, slip=float(slip)) for slip in slips]
    less, equal, more = (
        float(with_noise(target, one).costs_of(simulator, [structure.plant])[0]) for one in noises
    )
    share = structure.plant.values[LOST]
    bend = min((less + more - 2.0 * equal) / _SLIP_STEP**2, 0.5 * linear.innovations.size)
    if bend <= 0.0:
        return covariance
    told = bend / (share * _MODEL_DOUBT) ** 2
    along = covariance[place]
    return np.asarray(covariance - np.outer(along, along) / (1.0 / told + along[place]))


def robust_covariance(simulator: Simulator, linear: Linear, *, block_s: float = BLOCK_S) -> FloatArray:
    """Covariance of the structure's variables, SI, shape (variables, variables).

    In each direction, the larger of the Gauss-Newton covariance and a sandwich estimate. The sandwich's
    middle is the scatter of the scores over blocks of time (Newey and West's idea, with blocks). Correlated
    innovations make blocks scatter more than single readings. The weak priors enter as evidence of their own.
    Unknown inputs add to it: the supply between battery readings, fixed parameters, the encoder's zero within a step,
    and the choice of a law (`Parameter.law`).
    """
    variables = linear.variables
    scale = np.array([v.scale for v in variables])
    bread = linear.slopes @ linear.slopes.T / _MODEL_DOUBT**2 + np.diag(linear.tightness)
    inverse: FloatArray = np.asarray(
        np.linalg.pinv(bread + 1e-12 * np.eye(scale.size), hermitian=True), dtype=np.float64
    )
    filling = _block_scatter(linear, block_s) / _MODEL_DOUBT**2 + np.diag(linear.tightness)
    sandwich: FloatArray = inverse @ filling @ inverse
    spread = _larger(inverse, sandwich)
    untold = [
        (_SUPPLY_DOUBT / _SUPPLY_MOVE, _supply_signature(simulator, linear)),
        (FROZEN_DOUBT / _FROZEN_MOVE, _frozen(simulator, linear)),
        (_ZERO_DOUBT, _zero_signature(simulator, linear)),
    ]
    shifts = np.concatenate([size * linear.absorbed(signature) for size, signature in untold])
    spread = spread + shifts.T @ shifts + np.diag(_law_doubts(linear) ** 2)
    return np.asarray(spread * np.outer(scale, scale))


def _law_doubts(linear: Linear) -> FloatArray:
    """What laws of the same name leave open of each variable, in its scale, shape (variables,)."""
    plant = linear.structure.plant
    slots = [variable.slots[0] for variable in linear.variables]
    laws = np.array([plant.layout.parameters[slot].law * plant.values[slot] for slot in slots])
    return np.asarray(laws / np.array([variable.scale for variable in linear.variables]))


def _zero_signature(simulator: Simulator, linear: Linear) -> FloatArray:
    """What it would do to the predictions if every reading were a quantum higher, the quantum itself taken off."""
    jobs = []
    for job in linear.jobs:
        signals, start = job.signals, job.start
        higher = replace(signals, measured=signals.measured + signals.quantum)
        jobs.append(
            replace(job, signals=higher, start=replace(start, position=start.position + signals.quantum))
        )
    if any(job.signals.is_speed for job in jobs):
        return np.zeros((1, linear.innovations.size))
    values, active = linear.structure.plant.vectors()
    moved = [
        replace(result, predicted=result.predicted - job.signals.quantum)
        for result, job in zip(simulator.run(values[None], active[None], jobs), jobs, strict=True)
    ]
    return linear.whitened(moved)


def _frozen(simulator: Simulator, linear: Linear) -> FloatArray:
    """What each parameter that the fit leaves alone would do to the readings if it were a little larger."""
    plant = linear.structure.plant
    shares = {effect.id for effect in plant.effects if "outlier" in effect.terms}
    moved = [
        plant.with_values({slot: (1.0 + _FROZEN_MOVE) * plant.values[slot]})
        for slot, parameter in plant.layout.parameters.items()
        if parameter.frozen and slot in plant.values and slot.owner not in shares
    ]
    return deviations(simulator, linear, moved)


def _supply_signature(simulator: Simulator, linear: Linear) -> FloatArray:
    """What a slightly higher supply does to the readings; nothing where the command is no duty."""
    if any(job.signals.input_kind != "power_pct" for job in linear.jobs):
        return np.zeros((1, linear.innovations.size))
    more = 1.0 + _SUPPLY_MOVE
    jobs = [
        replace(job, signals=replace(job.signals, command_supply_v=more * job.signals.command_supply_v))
        for job in linear.jobs
    ]
    values, active = linear.structure.plant.vectors()
    return linear.whitened(simulator.run(values[None], active[None], jobs))


def _block_scatter(linear: Linear, most_s: float) -> FloatArray:
    """Sum over blocks of time of the outer products of their scores, with the small-sample factor."""
    length_s = max(float(linear.time_s.max()), 1e-9)
    block_s = min(most_s, length_s * len(linear.jobs) / _FEWEST_BLOCKS)
    block = linear.run * (math.ceil(length_s / block_s) + 1) + np.floor(linear.time_s / block_s).astype(int)
    _, number = np.unique(block, return_inverse=True)
    count = int(number.max()) + 1
    scores = np.zeros((count, linear.slopes.shape[0]))
    np.add.at(scores, number, (linear.slopes * linear.innovations).T)
    factor = count / max(count - linear.slopes.shape[0], 1)
    return np.asarray(factor * (scores.T @ scores), dtype=np.float64)


def _larger(plain: FloatArray, robust: FloatArray) -> FloatArray:
    """`robust`, raised where it is below `plain`: directions in which blocks happen to scatter little."""
    spread = np.sqrt(np.maximum(np.diag(plain), 1e-300))
    scaled = robust / np.outer(spread, spread)
    correlation = plain / np.outer(spread, spread)
    values, vectors = np.linalg.eigh(correlation)
    root = vectors @ np.diag(np.sqrt(np.maximum(values, 0.0))) @ vectors.T
    back = vectors @ np.diag(1.0 / np.sqrt(np.maximum(values, 1e-12))) @ vectors.T
    shares, axes = np.linalg.eigh(back @ scaled @ back)
    raised = root @ axes @ np.diag(np.maximum(shares, 1.0)) @ axes.T @ root
    return np.asarray(raised * np.outer(spread, spread))
