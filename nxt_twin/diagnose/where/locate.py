"""Where a baseline fails: when, and in which regime."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.diagnosis import RegimeFinding, Spell
from nxt_twin.diagnose.fitting.residuals import Residuals
from nxt_twin.physics.effect import Regime

_WINDOW_S = 0.5  # s: length of the windows in which squared innovations are averaged
_SPELL_SIGMAS = 5.0  # standard deviations by which a window's mean square has to exceed that of noise
_MOST_SPELLS = 8  # stretches that are listed, the strongest ones
_SHIFTS = 400  # random shifts of the innovations, with which each regime is compared
_SIGNIFICANT = 0.02  # largest p-value of a regime that is listed
_JUST_AFTER_S = 0.15  # s after a reversal or a command, within which readings belong to it


def spells(found: Residuals, names: Sequence[str]) -> tuple[Spell, ...]:
    """Stretches in which the squared innovations exceed what noise gives, strongest first."""
    listed = []
    for run, name in enumerate(names):
        mine = found.run == run
        listed += _spells_of_one(found.time_s[mine], found.normalised[mine], name)
    listed.sort(key=lambda spell: -spell.strength)
    return tuple(listed[:_MOST_SPELLS])


def _spells_of_one(time_s: FloatArray, normalised: FloatArray, name: str) -> list[Spell]:
    window = np.floor(time_s / _WINDOW_S).astype(int)
    found: list[Spell] = []
    for number in np.unique(window):
        inside = window == number
        count = int(inside.sum())
        strength = (np.mean(normalised[inside] ** 2) - 1.0) * np.sqrt(count / 2.0)
        if count < 3 or strength < _SPELL_SIGMAS:
            continue
        start_s, end_s = float(number * _WINDOW_S), float((number + 1) * _WINDOW_S)
        if found and found[-1].end_s == start_s:
            last = found.pop()
            start_s, strength = last.start_s, max(last.strength, strength)
        found.append(Spell(name, start_s, end_s, float(strength)))
    return found


def regimes(found: Residuals, seed: int) -> tuple[RegimeFinding, ...]:
    """Regimes in which the mismatch gathers, strongest first.

    Each statistic is compared with its values after random shifts of the innovations against the plant's
    state. A shift keeps the innovations' own correlation. The p-value is the share of shifts that do as well;
    the strength is the distance from their mean, in standard deviations.
    """
    rng = np.random.default_rng(seed)
    size = found.normalised.size
    shifts = rng.integers(size // 20 + 1, max(size - size // 20, size // 20 + 2), size=_SHIFTS)
    listed = []
    for regime, weights, signed in _contrasts(found):
        values = found.normalised if signed else found.normalised**2
        centred = weights - weights.mean()
        spread = float(np.std(centred))
        if spread < 1e-9:
            continue
        twice = np.concatenate([values, values])  # each shift is a view of it, and no copy
        chance = np.array([twice[size - shift : 2 * size - shift] @ centred for shift in shifts])
        observed = float(np.dot(values, centred))
        if signed:
            chance, observed = np.abs(chance), abs(observed)
        strength = (observed - chance.mean()) / max(float(chance.std()), 1e-12)
        p_value = (1.0 + np.sum(chance >= observed)) / (1.0 + _SHIFTS)
        if p_value <= _SIGNIFICANT:
            listed.append(RegimeFinding(regime, float(strength), float(p_value)))
    best: dict[str, RegimeFinding] = {}
    for finding in sorted(listed, key=lambda finding: finding.strength):
        best[finding.regime] = finding
    return tuple(sorted(best.values(), key=lambda finding: -finding.strength))


def _contrasts(found: Residuals) -> list[tuple[Regime, FloatArray, bool]]:
    """For each regime a weight per reading, and whether innovations (True) or their squares go with it."""
    speed = np.abs(found.speed)
    ordinary = max(float(np.sqrt(np.mean(speed**2))), 1e-12)
    reversed_at = np.flatnonzero(np.diff(np.sign(found.speed), prepend=0.0) != 0.0)
    last = np.maximum.accumulate(
        np.where(np.isin(np.arange(speed.size), reversed_at), np.arange(speed.size), 0)
    )
    after_reversal = found.time_s - found.time_s[last]
    reversal = (after_reversal >= 0.0) & (after_reversal < _JUST_AFTER_S)
    typical_gap_s = float(np.median(found.gap_s))
    listed: list[tuple[Regime, FloatArray, bool]] = [
        ("low_speed", (speed < 0.1 * ordinary).astype(float), False),
        ("reversal", reversal.astype(float), False),
        ("high_speed", (speed > np.quantile(speed, 0.8)).astype(float), False),
        ("high_current", (np.abs(found.drive) > np.quantile(np.abs(found.drive), 0.8)).astype(float), False),
        ("after_command", (found.since_command_s < _JUST_AFTER_S).astype(float), False),
        ("after_gap", (found.gap_s > 3.0 * typical_gap_s).astype(float), False),
        ("direction", np.sign(found.speed) * (speed > 0.1 * ordinary), True),
        ("elapsed_time", found.time_s, False),
    ]
    listed += [("angle", wave(found.position), True) for wave in (np.sin, np.cos)]
    return listed
