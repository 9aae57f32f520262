"""Moments that each recording has for itself: when something sets in there, and where a clock stands as it begins."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.target import Target
from nxt_twin.diagnose.fitting.variables import scale_of
from nxt_twin.physics.signals import Signals


def lengths_s(problem: Problem) -> dict[str, float]:
    """The length of each recording by name, s, of those that are held out as well."""
    return {one.name: float(np.ptp(one.time_s)) for one in recordings_of(problem)}


def setting_in(problem: Problem, began_s: Mapping[str, float], sets_in_s: float) -> Problem:
    """`problem` with each recording begun so that something sets in at one moment of the session in all of them.

    Args:
        problem: with recordings in one session, whatever their order.
        began_s: when each recording begins, s of the session, by name.
        sets_in_s: that moment, s of the session.
    """
    return _with_each(problem, lambda one: replace(one, session_s=began_s[one.name], sets_in_s=sets_in_s))


def with_clocks(problem: Problem, clock_s: Mapping[str, float]) -> Problem:
    """`problem` with how far on a clock that wanders is as each recording begins, s, by name."""
    return _with_each(problem, lambda one: replace(one, clock_s=clock_s[one.name]))


def _with_each(problem: Problem, changed: Callable[[Signals], Signals]) -> Problem:
    """`problem` with all its recordings `changed`."""
    made: dict[int, Signals] = {}  # by identity: what is held out of a recording shares its signals

    def at(one: Signals) -> Signals:
        if id(one) not in made:
            made[id(one)] = changed(one)
        return made[id(one)]

    def of(target: Target) -> Target:
        return replace(target, jobs=tuple(replace(job, signals=at(job.signals)) for job in target.jobs))

    signals = tuple(at(one) for one in problem.signals)
    return replace(
        problem,
        scale=scale_of(problem.plant, signals),
        target=of(problem.target),
        simulated=of(problem.simulated),
        held_out=tuple(replace(part, signals=at(part.signals)) for part in problem.held_out),
        signals=signals,
    )


def recordings_of(problem: Problem) -> list[Signals]:
    """Each recording once, those that are held out as well."""
    parts = (*problem.signals, *(part.signals for part in problem.held_out))
    return list({one.name: one for one in parts}.values())
