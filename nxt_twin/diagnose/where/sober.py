"""How much a law would explain beside found effects if the unknown torque did not stand for it.

Where physics is missing, the estimated unknown torque grows until it explains what the missing law does. A free
function then gains little beside it. So less noise is allowed here, between the estimate and what a complete model
leaves. A function counts by what it gains beyond the likelier of both noises alone.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import chain
from typing import Final

from nxt_twin.diagnose.fitting.linear import Linear, linearise
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.where.marginal import likeliest
from nxt_twin.diagnose.where.noises import between, noises, readings_nats
from nxt_twin.diagnose.where.setting_in import SETTING_IN
from nxt_twin.diagnose.where.shapes import LAWS, ShapeFamily
from nxt_twin.diagnose.where.staged import Staged, answers, staged
from nxt_twin.physics.simulate import Simulator

ASKED: Final[tuple[ShapeFamily, ...]] = (*LAWS, *chain.from_iterable(SETTING_IN.values()))
"""Functions of speed, angle, time and command, and torques that set in somewhere."""


def sober_nats(simulator: Simulator, problem: Problem, structure: Structure) -> float:
    """The most that one of `ASKED` gains beside `structure`, under its own noise or a soberer one, nats."""
    asked, complete = noises(simulator, problem, structure)
    linears = [
        linearise(simulator, problem, replace(structure, noise=noise))
        for noise in dict.fromkeys((asked, between(asked, complete)))
    ]
    scene = staged(simulator, problem, linears[0])
    alone = [readings_nats(scene, linear) for linear in linears]
    best = [
        own + max(heard(scene, linear, shape) for shape in ASKED)
        for own, linear in zip(alone, linears, strict=True)
    ]
    gained = max(best) - max(alone)
    return gained if math.isfinite(gained) else 0.0  # a run that blew up


def heard(scene: Staged, linear: Linear, shape: ShapeFamily) -> float:
    """Gain of the likeliest function of one family beside `linear`, nats."""
    rows = (shape.rows(course, scene.unit) for course in scene.courses)
    return likeliest(linear, answers(scene, linear, rows, shape.entry))
