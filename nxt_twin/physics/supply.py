"""The open-circuit voltage of a battery, from few and noisy readings that show whatever was drawn at their moment."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray

_AT_REST: Final = 0.05  # of the largest effort
_QUIET_SHARE: Final = 0.3  # of the readings, those at the least effort
_FEWEST: Final = 8  # readings that tell noise and sag apart
_FEWEST_AT_REST: Final = 4  # that tell the noise by themselves
_ROUNDS: Final = 12
_UNLIKE: Final = 0.5  # of the sag: how far it strays from growing with the effort
_LEAST_NOISE_V: Final = 0.003
_MOST_SAG_V: Final = 1.0  # at full effort, ordinarily
_FAR: Final = 2.0  # standard deviations beyond which a reading counts less


@final
@dataclass(frozen=True)
class _Loaded:
    """A line of time, less what grows with the effort.

    Attributes:
        level_v: where the middle of time is, without effort.
        slope_v_per_s: of time.
        sag_v: at an effort of one, at least 0.
        noise_v: standard deviation of a reading at rest.
        level_std_v: standard deviation of the level, if the sag grows with the effort.
    """

    level_v: float
    slope_v_per_s: float
    sag_v: float
    noise_v: float
    level_std_v: float


def open_circuit(time_s: FloatArray, volts: FloatArray, effort: FloatArray) -> tuple[float, float]:
    """Level at time zero, V, and slope, V/s, of the open-circuit voltage, from readings of shape (readings,).

    Readings at rest show it as it is. They are few, and a recording may hold only one, which is as noisy as any. Those
    under load are many, and lower by a sag that grows about with the effort. Both estimates of the level are weighed by
    what they may be off: the noise, and a share of the sag.

    Args:
        time_s: when each was taken.
        volts: the readings.
        effort: what was drawn then: the sum of the duties in force, 0 at rest.
    """
    at_rest = effort <= _AT_REST * float(effort.max())
    if volts.size < _FEWEST:
        return _by_the_quiet(time_s, volts, effort, at_rest)
    middle_s = float(time_s.mean())
    line = _line(time_s - middle_s, volts, effort, at_rest)
    level_v = line.level_v
    if at_rest.any():
        rest_v = float(np.median((volts - line.slope_v_per_s * (time_s - middle_s))[at_rest]))
        rest = line.noise_v**2 / int(at_rest.sum())
        loaded = line.level_std_v**2 + (_UNLIKE * line.sag_v * float(effort.mean())) ** 2
        level_v = (rest_v / rest + level_v / loaded) / (1.0 / rest + 1.0 / loaded)
    return level_v - line.slope_v_per_s * middle_s, line.slope_v_per_s


def _line(time_s: FloatArray, volts: FloatArray, effort: FloatArray, at_rest: BoolArray) -> _Loaded:
    """The likeliest line, sag and noise in turn; readings that are far off count less."""
    design = np.stack([np.ones_like(time_s), time_s, -effort])
    sag_v, left_v = 0.0, volts - np.median(volts)
    noise_v = _noise_v(left_v, np.zeros_like(volts), at_rest)
    for _ in range(_ROUNDS):
        std = np.hypot(noise_v, _UNLIKE * sag_v * effort)
        weight = 1.0 / (std**2 + (left_v / _FAR) ** 2)
        found, level_std_v = _regression(design, volts, weight)
        sag_v, left_v = float(found[2]), volts - found @ design
        noise_v = _noise_v(left_v, _UNLIKE * sag_v * effort, at_rest)
    return _Loaded(float(found[0]), float(found[1]), sag_v, noise_v, level_std_v)


def _regression(design: FloatArray, volts: FloatArray, weight: FloatArray) -> tuple[FloatArray, float]:
    """Level, slope and sag, and the level's standard deviation; no sag where it would come out below zero."""
    weighted = design * weight
    hessian = weighted @ design.T + np.diag([0.0, 0.0, 1.0 / _MOST_SAG_V**2])
    covariance = np.linalg.pinv(hessian, hermitian=True)
    found = covariance @ (weighted @ volts)
    if found[2] <= 0.0:
        covariance = np.linalg.pinv(hessian[:2, :2], hermitian=True)
        found = np.append(covariance @ (weighted[:2] @ volts), 0.0)
    return found, float(np.sqrt(covariance[0, 0]))


def _noise_v(left_v: FloatArray, unlike_v: FloatArray, at_rest: BoolArray) -> float:
    """What a reading is off, by those at rest if there are some, else beside what the sag may be off."""
    own = at_rest if int(at_rest.sum()) >= _FEWEST_AT_REST else np.ones_like(at_rest)
    scatter = np.square(1.4826 * np.median(np.abs(left_v[own]))) - float(np.mean(np.square(unlike_v[own])))
    return float(np.sqrt(max(scatter, _LEAST_NOISE_V**2)))


def _by_the_quiet(
    time_s: FloatArray, volts: FloatArray, effort: FloatArray, at_rest: BoolArray
) -> tuple[float, float]:
    """A line through the few readings at the least effort, by Theil and Sen; those at rest, if any, set its level."""
    quiet = at_rest | (effort <= np.quantile(effort, _QUIET_SHARE))
    t, v = time_s[quiet], volts[quiet]
    half = t.size // 2
    slope = 0.0
    if half >= 3 and t[-half:].min() > t[:half].max():
        slope = float(np.median((v[-half:] - v[:half]) / (t[-half:] - t[:half])))
    level = at_rest if at_rest.any() else quiet
    return float(np.median(volts[level] - slope * time_s[level])), slope
