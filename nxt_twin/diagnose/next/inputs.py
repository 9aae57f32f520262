"""A family of inputs that are safe to try on a motor that turns freely, each a pattern that may be repeated."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import final

from nxt_twin.recording.columns import DriveMode
from nxt_twin.recording.program import Segment

_CHIRP_STEP_S = 0.05  # for which each power of a rising sine is held


@final
@dataclass(frozen=True)
class Pattern:
    """One input of the family.

    Attributes:
        words: what is done, for a person; `{unit}` stands for the unit of the command.
        segments: one period of it.
        coasts: it lets the motor run out without current, which only a bridge can do.
    """

    words: str
    segments: tuple[Segment, ...]
    coasts: bool = False

    @property
    def period_s(self) -> float:
        """How long one period lasts, s."""
        return sum(segment.duration_s for segment in self.segments)

    def lasting(self, seconds: float) -> tuple[Segment, ...]:
        """Whole periods that together last at least `seconds`."""
        return self.segments * max(1, math.ceil(seconds / self.period_s - 1e-9))


def family(most_pct: int) -> Iterator[Pattern]:
    """Inputs of at most `most_pct` percent, simple ones first."""
    half, small = max(most_pct // 2, 10), max(min(most_pct, 25), 10)
    for power in (most_pct, half):
        for hold_s in (0.4, 1.2):
            yield _steps(power, hold_s)
        for hold_s in (0.15, 0.35):
            yield _reversals(power, hold_s)
    yield _sizes(most_pct)
    for power, ramp_s in ((most_pct, 2.0), (half, 2.0), (small, 1.5), (small, 4.0)):
        yield _ramps(power, ramp_s)
    for power, spin_s, coast_s in ((most_pct, 0.6, 1.0), (half, 0.5, 0.8), (most_pct, 0.25, 0.5)):
        yield _run_out(power, spin_s, coast_s, "coast")
    yield _run_out(most_pct, 0.5, 0.5, "brake")
    yield _levels(most_pct, 2.0)
    yield _levels(most_pct, 0.7)
    yield _one_way(half, 6.0)
    yield _one_way(most_pct, 6.0)
    yield _rests(most_pct)
    for power in (most_pct, half):
        yield _chirp(power, 6.0)


def _steps(power: int, hold_s: float) -> Pattern:
    parts = [_hold(p, hold_s) for p in (power, 0, -power, 0)]
    return Pattern(f"steps of ±{power} {{unit}} and back to rest, each held {hold_s:g} s", tuple(parts))


def _reversals(power: int, hold_s: float) -> Pattern:
    parts = (_hold(power, hold_s), _hold(-power, hold_s))
    return Pattern(f"reversals between +{power} and −{power} {{unit}} every {hold_s:g} s", parts)


def _sizes(most: int) -> Pattern:
    sizes = [round(most * share) for share in (0.25, 0.5, 0.75, 1.0)]
    parts = [_hold(sign * size, 0.5) for size in sizes for sign in (1, 0, -1, 0)]
    listed = ", ".join(map(str, sizes))
    return Pattern(f"steps both ways of {listed} {{unit}} with rests between, 0.5 s each", tuple(parts))


def _ramps(power: int, ramp_s: float) -> Pattern:
    knots = (0, power, 0, -power, 0)
    parts = [Segment(duration_s=ramp_s, power_pct=a, end_power_pct=b) for a, b in itertools.pairwise(knots)]
    return Pattern(f"slow ramps through zero to ±{power} {{unit}}, {ramp_s:g} s each way", tuple(parts))


def _run_out(power: int, spin_s: float, rest_s: float, mode: DriveMode) -> Pattern:
    rest = Segment(duration_s=rest_s, mode=mode)
    parts = (_hold(power, spin_s), rest, _hold(-power, spin_s), rest)
    how = "let it run out without current" if mode == "coast" else "brake it"
    words = f"spin up with ±{power} {{unit}} for {spin_s:g} s, then {how} for {rest_s:g} s"
    return Pattern(words, parts, coasts=True)


def _levels(most: int, hold_s: float) -> Pattern:
    sizes = [round(most * share) for share in (0.3, 0.6, 1.0)]
    parts = [_hold(sign * size, hold_s) for sign in (1, -1) for size in sizes]
    listed = ", ".join(map(str, sizes))
    return Pattern(f"steady speeds at {listed} {{unit}}, forward then back, {hold_s:g} s each", tuple(parts))


def _one_way(power: int, hold_s: float) -> Pattern:
    words = f"{power} {{unit}} one way for {hold_s:g} s, a rest, then the other way"
    return Pattern(words, (_hold(power, hold_s), _hold(0, 1.0), _hold(-power, hold_s), _hold(0, 1.0)))


def _rests(most: int) -> Pattern:
    parts = (_hold(most, 0.5), _hold(0, 4.0), _hold(-most, 0.5), _hold(0, 4.0))
    return Pattern(f"short pushes of ±{most} {{unit}} for 0.5 s with long rests of 4 s", parts)


def _chirp(power: int, length_s: float) -> Pattern:
    count = round(length_s / _CHIRP_STEP_S)
    parts = []
    for n in range(count):
        at = n / count
        turns = length_s * (0.3 * at + 0.5 * (4.0 - 0.3) * at**2)
        parts.append(_hold(round(power * math.sin(2.0 * math.pi * turns)), _CHIRP_STEP_S))
    return Pattern(f"a sine of {power} {{unit}} that rises from 0.3 to 4 Hz in {length_s:g} s", tuple(parts))


def _hold(power: int, duration_s: float) -> Segment:
    return Segment(duration_s=duration_s, power_pct=power)
