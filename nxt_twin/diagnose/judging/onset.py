"""When an effect came on, where fitted readings leave that open: then what was held out has to say."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from nxt_twin.diagnose.fitting.fitter import SETTLED, Fitter
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.judging.horizons import errors_of, least_wrong
from nxt_twin.diagnose.search.onset import at_onset, has_onset, removed_at
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Simulator

_OPEN_NATS = 8.0
"""Nats by which an open moment may be less likely, on all readings that are not held out: what an effect has to gain.

A payload that is hung on between two recordings fits best a few readings after the second one began.
"""
_CLEARLY = 0.8  # of the error on held-out readings: another onset has to leave less
_MOMENTS = 12  # tried within each held-out recording, beside its beginning and its end
_MOST_TRIED = 24  # open moments that are simulated over held-out readings at most


def placed(simulator: Simulator, problem: Problem, final: Structure) -> tuple[Structure, tuple[Effect, ...]]:
    """`final` with onsets where held-out recordings show them, and the effects whose onset these had to tell.

    A payload put on between two recordings may have come on before, after or within one between them that no fit saw.
    Only moments that fitted readings cannot tell from the fitted onset are tried.
    """
    told = []
    for effect in final.plant.layout.effects:
        if effect.id in final.plant.active and has_onset(effect):
            moved = _likelier(simulator, problem, final, effect)
            if moved is not None:
                final = replace(final, fitted=replace(final.fitted, plant=moved))
                told.append(effect)
    return final, tuple(told)


def _likelier(simulator: Simulator, problem: Problem, final: Structure, effect: Effect) -> Plant | None:
    """The plant with an open onset under which what was held out is simulated clearly better, if there is one."""
    every = [
        final.plant,
        *(removed_at(final.plant, effect, ends_s) for ends_s in _ends(problem)),
        *(at_onset(final.plant, effect, moment_s) for moment_s in _moments(problem)),
    ]
    tuned = Fitter(simulator, problem).tuned(final.noise, SETTLED.step_for(final.plant)).everything()
    costs = tuned.costs_of(simulator, every)
    opened = [plant for plant, cost in zip(every, costs, strict=True) if cost - costs[0] <= _OPEN_NATS]
    errors = [errors_of(simulator, problem, plant, plant, final.noise) for plant in opened[: 1 + _MOST_TRIED]]
    best = least_wrong(errors, problem.tolerance)
    before, after = (float(np.mean(one.rms)) for one in (errors[0], errors[best]))
    return opened[best] if max(after, problem.tolerance) < _CLEARLY * before else None


def _ends(problem: Problem) -> Iterator[float]:
    """Beginning and end of each recording that is held out as a whole or in part, s of the session."""
    for part in problem.held_out:
        began_s = part.signals.session_s
        yield began_s
        yield began_s + float(np.ptp(part.signals.time_s))


def _moments(problem: Problem) -> Iterator[float]:
    """Beginning, end and some moments within each held-out recording, s of the session."""
    for part in problem.held_out:
        times_s = part.signals.time_s[part.counted]
        began_s = part.signals.session_s - float(part.signals.time_s[0])
        yield part.signals.session_s  # some time before the first reading that counts
        for moment_s in np.linspace(times_s[0], times_s[-1], _MOMENTS + 2):
            yield began_s + float(moment_s)
