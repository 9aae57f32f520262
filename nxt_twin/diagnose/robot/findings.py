"""The named effects of a robot with their parameters and doubts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from scipy.special import stdtrit

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.diagnosis import Confusion, DetectableSize, Estimate, FoundEffect, Moved
from nxt_twin.diagnose.robot.choice import NEEDED_NATS
from nxt_twin.diagnose.robot.effects import CLOCK_SKEW, GEOMETRY, POSE_OFFSET, WHEEL_SLIP, RobotEffect
from nxt_twin.diagnose.robot.fit import FittedGeometry
from nxt_twin.diagnose.robot.search import RobotFindings
from nxt_twin.diagnose.robot.slip import SlipSpell
from nxt_twin.diagnose.robot.windows import PARAMETERS
from nxt_twin.diagnose.robot.words import why_confusable
from nxt_twin.physics.robot.drive import Geometry

_NINE_OF_TEN: Final = 1.2816  # standard deviations above the mean that nine of ten normal values stay below
_SURE: Final = 0.999  # probability told of a clock, of slip and of compared markers, once found
_MOST_LAGS: Final = (0.05, 0.95)


def found_effects(found: RobotFindings) -> tuple[FoundEffect, ...]:
    """The named effects, the geometry first."""
    effects = [_of_geometry(effect, found) for effect in found.choice.named]
    if found.final.clock:
        effects.append(_clock(found))
    if found.slips:
        effects.append(slip_effect(found.slips))
    return tuple(effects)


def moved_parameters(found: RobotFindings, given: Geometry) -> dict[str, Moved]:
    """Wheels and track as far as these paths tell them: from where they were given to where the final fit has them."""
    after = found.final.state.as_geometry
    covariance = _covariance(found)
    radius, ratio = after.mean_wheel_radius_m, after.wheel_radius_ratio
    slopes = {
        "left_wheel_radius_m": np.array([2.0 / (1.0 + ratio), -2.0 * radius / (1.0 + ratio) ** 2]),
        "right_wheel_radius_m": np.array([2.0 * ratio / (1.0 + ratio), 2.0 * radius / (1.0 + ratio) ** 2]),
    }
    moved = {}
    for name, slope in slopes.items() if found.full.free[:2].all() else ():
        std = float(np.sqrt(slope @ covariance[:2, :2] @ slope))
        moved[name] = _moved(getattr(given, name), getattr(after, name), std, found)
    moved["track_m"] = _moved(given.track_m, after.track_m, float(np.sqrt(covariance[2, 2])), found)
    return moved


def sizes_seen(found: RobotFindings) -> tuple[DetectableSize, ...]:
    """For each geometry effect that is not named, the smallest size seen nine times of ten."""
    named = {effect.id for effect in found.choice.named}
    needed = float(np.sqrt(_squared_for(NEEDED_NATS, found.full.clusters)))
    sizes = []
    for effect in GEOMETRY:
        name = tuple(effect.units)[-1]
        if effect.id in named or not found.full.free[PARAMETERS.index(name)]:
            continue
        std = float(np.sqrt(found.full.covariance[PARAMETERS.index(name), PARAMETERS.index(name)]))
        size = (needed + _NINE_OF_TEN) * std
        sizes.append(DetectableSize(effect.id, effect.name, name, size, effect.units[name], seen_above=True))
    return tuple(sizes)


def _squared_for(nats: float, clusters: int) -> float:
    """The squared distance in standard deviations that is worth so many nats."""
    return max(clusters - 1, 1) * float(np.expm1(2.0 * nats / clusters))


def _of_geometry(effect: RobotEffect, found: RobotFindings) -> FoundEffect:
    covariance = _covariance(found)
    params = {}
    for name, unit in effect.units.items():
        place = PARAMETERS.index(name)
        if not found.full.free[place]:
            continue
        std = float(np.sqrt(covariance[place, place]))
        params[name] = _estimate(float(found.final.state.geometry[place]), std, unit, found.final)
    confusable = tuple(
        Confusion(other, why_confusable(effect.id, other)) for other in found.choice.rivals[effect.id]
    )
    return FoundEffect(
        effect.id, effect.name, effect.equation, params, found.choice.probability[effect.id], confusable
    )


def pose_effect(told: Mapping[str, tuple[float, float]], reach: float) -> FoundEffect:
    """The markers' offset from values and standard deviations of some of its parameters; taken for certain."""
    params = {
        name: Estimate(value, std, POSE_OFFSET.units[name], (value - reach * std, value + reach * std))
        for name, (value, std) in told.items()
    }
    return FoundEffect(POSE_OFFSET.id, POSE_OFFSET.name, POSE_OFFSET.equation, params, _SURE, ())


def _clock(found: RobotFindings) -> FoundEffect:
    """The lags of all recordings: their mean, from the earliest to the latest, and how fast they grow."""
    state, std = found.final.state, found.final.lag_std
    half_s = np.array([0.5 * run.duration_s for run in found.runs])
    ends = np.concatenate([state.lag_s - state.rate * half_s, state.lag_s + state.rate * half_s])
    weight = 1.0 / np.maximum(std[:, 1], 1e-6) ** 2
    rate = float(np.sum(weight * state.rate) / np.sum(weight))
    count = max(state.lag_s.size, 2)
    scatter = (
        float(np.std(state.lag_s, ddof=1)) / np.sqrt(count) if state.lag_s.size > 1 else float(std[0, 0])
    )
    rate_std = float(
        np.sqrt(
            np.sum(weight * (state.rate - rate) ** 2) / np.sum(weight) / (count - 1) + 1.0 / np.sum(weight)
        )
    )
    values = {
        "lag_s": (float(state.lag_s.mean()), float(np.hypot(scatter, np.median(std[:, 0])))),
        "lag_span_s": (
            float(np.ptp(np.quantile(ends, _MOST_LAGS))),
            float(np.sqrt(2.0) * np.median(std[:, 0])),
        ),
        "rate_error": (rate, rate_std),
    }
    params = {
        name: Estimate(value, doubt, CLOCK_SKEW.units[name], (value - 2.0 * doubt, value + 2.0 * doubt))
        for name, (value, doubt) in values.items()
    }
    return FoundEffect(CLOCK_SKEW.id, CLOCK_SKEW.name, CLOCK_SKEW.equation, params, _SURE, ())


def slip_effect(slips: Sequence[SlipSpell]) -> FoundEffect:
    """Spells of slip as one effect, with the ratio that they have in common."""
    weight = np.array([1.0 / slip.std**2 for slip in slips])
    ratios = np.array([slip.ratio for slip in slips])
    mean = float(np.sum(weight * ratios) / np.sum(weight))
    spread = float(np.sqrt(np.sum(weight * (ratios - mean) ** 2) / np.sum(weight) / max(ratios.size - 1, 1)))
    doubt = float(np.hypot(spread, 1.0 / np.sqrt(np.sum(weight))))
    params = {"slip_ratio": Estimate(mean, doubt, "1", (mean - 2.0 * doubt, mean + 2.0 * doubt))}
    return FoundEffect(WHEEL_SLIP.id, WHEEL_SLIP.name, WHEEL_SLIP.equation, params, _SURE, ())


def _covariance(found: RobotFindings) -> FloatArray:
    """Of the final geometry, with what sessions differ by; what stayed as given has the full fit's doubt."""
    free = found.final.free
    covariance = np.where(
        np.outer(free, free), found.final.covariance, np.diag(np.diag(found.full.covariance))
    )
    between = [found.spread[name].between if name in found.spread else 0.0 for name in PARAMETERS]
    return np.asarray(covariance + np.diag(np.square(between)))


def _estimate(value: float, std: float, unit: str, fitted: FittedGeometry) -> Estimate:
    reach = _reach(fitted) * std
    return Estimate(value, std, unit, (value - reach, value + reach))


def _moved(before: float, after: float, std: float, found: RobotFindings) -> Moved:
    moved = Moved(before, after, std, "m")
    reach = _reach(found.final) * std
    return replace(moved, interval_95=(after - reach, after + reach))


def _reach(fitted: FittedGeometry) -> float:
    """Student's factor of a 95 % interval that rests on so many independent parts."""
    return float(stdtrit(max(fitted.clusters - 1, 2), 0.975))
