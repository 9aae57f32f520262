"""How much a free function would explain beside the effects that were found.

A near relative of the missing law takes most of the error away, as quadratic drag does for a brake that bites above
a speed. The rest still goes with speed, angle, time or command. A free function of those then makes
the fitted readings likelier, and it brings simulations of readings that no fit has seen nearer.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.fitting.linear import Linear, moves
from nxt_twin.diagnose.fitting.observed import observed_starts
from nxt_twin.diagnose.fitting.problem import HeldOut
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.judging.evidence import Evidence
from nxt_twin.diagnose.judging.verdict import LIMITS
from nxt_twin.diagnose.where.course import Course, course_of
from nxt_twin.diagnose.where.marginal import Missing
from nxt_twin.diagnose.where.response import free_response
from nxt_twin.diagnose.where.rested import RESTED
from nxt_twin.diagnose.where.setting_in import kin_of
from nxt_twin.diagnose.where.shapes import SHAPES, ShapeFamily
from nxt_twin.diagnose.where.sober import heard, sober_nats
from nxt_twin.diagnose.where.staged import Staged, staged
from nxt_twin.physics.observer import observer
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Job, Simulator, free_job
from nxt_twin.physics.start import moving_start


@final
@dataclass(frozen=True)
class _Unseen:
    """Simulated windows of a recording, or of a part of it, that no fit has seen.

    Attributes:
        signals: the recording.
        anew: where a window starts, shape (samples,).
        judged: which samples count, shape (samples,).
        errors: of the simulation, SI, shape (samples,).
        slopes: of the simulation for each variable, in its scale, shape (variables, samples).
        course: what the plant does.
    """

    signals: Signals
    anew: BoolArray
    judged: BoolArray
    errors: FloatArray
    slopes: FloatArray
    course: Course


def with_shapes(simulator: Simulator, evidence: Evidence) -> Evidence:
    """`evidence` whose record also tells what a shape explains beside the found effects, where this is asked."""
    if not evidence.record.found:
        return evidence
    nats = sober_nats(simulator, evidence.problem, evidence.final)
    evidence = replace(evidence, record=replace(evidence.record, sober_nats=nats))
    return evidence if evidence.record.by_windows else _with_kin(simulator, evidence)


def _with_kin(simulator: Simulator, evidence: Evidence) -> Evidence:
    """`evidence` whose record also tells what near relatives of the found effects explain."""
    record = evidence.record
    scene = staged(simulator, evidence.problem, evidence.linear)
    found = [effect for effect, _ in evidence.explanation.found]
    kin = [shape for effect in found for shape in kin_of(effect)]
    torques = all(effect.equation_of == "torque_balance" and not effect.states for effect in found)
    slow = any("low_speed" in effect.shows and "angle" not in effect.shows for effect in found)
    record = replace(
        record,
        rested_nats=_most_nats(scene, evidence.linear, RESTED if torques and slow else ()),
        kin_nats=_most_nats(scene, evidence.linear, kin),
    )
    if record.remaining > LIMITS.nearly:
        nats, left = _beyond(simulator, evidence, scene)
        record = replace(record, shape_nats=nats / max(record.colour, 1.0), shape_left=left)
    return replace(evidence, record=record)


def _beyond(simulator: Simulator, evidence: Evidence, scene: Staged) -> tuple[float, float]:
    """The most that a shape gains, nats, and the least share of the unseen error that is left with a likely one."""
    linear = evidence.linear
    every = [(shape, heard(scene, linear, shape)) for shape in SHAPES]
    likely = [(shape, missing) for shape, missing in every if missing.nats > LIMITS.shaped]
    unseen = _unseen(simulator, evidence) if likely else []
    left = [_left(unseen, scene, linear.structure, *one) for one in likely]
    return max(missing.nats for _, missing in every), min(left, default=1.0)


def _most_nats(scene: Staged, linear: Linear, shapes: Iterable[ShapeFamily]) -> float:
    return max((heard(scene, linear, shape).nats for shape in shapes), default=0.0)


def _unseen(simulator: Simulator, evidence: Evidence) -> list[_Unseen]:
    found: list[_Unseen] = []
    for part in evidence.problem.held_out:
        begins_s = float(found[-1].course.laid_s[-1]) if found else 0.0
        found.append(_unseen_part(simulator, evidence, part, begins_s))
    return found


def _unseen_part(simulator: Simulator, evidence: Evidence, part: HeldOut, begins_s: float) -> _Unseen:
    """Simulate the final plant, and small moves of its variables, over `part` in windows."""
    problem, structure, signals = evidence.problem, evidence.final, part.signals
    plant, noise, first = structure.plant, structure.noise, moving_start(part.signals)
    start = observed_starts(simulator, plant, signals, first, noise, problem.window_s)
    sets, widths = moves(plant, evidence.linear.variables)
    _, active = plant.vectors()
    job = free_job(signals, start)
    runs = simulator.run(sets, np.repeat(active[None], len(sets), axis=0), [job])[0].predicted
    corrected = Job(signals, observer(signals, noise), first, noise.disturbance_time_s)
    return _Unseen(
        signals=signals,
        anew=start.at,
        judged=part.counted & ~start.at & np.isfinite(signals.measured),
        errors=signals.measured - runs[-1],
        slopes=np.nan_to_num((runs[:-1:2] - runs[1:-1:2]) / widths[:, None]),
        course=course_of(simulator, plant, corrected, begins_s),
    )


def _left(
    unseen: Iterable[_Unseen], scene: Staged, structure: Structure, shape: ShapeFamily, missing: Missing
) -> float:
    """The error over all unseen windows with `missing` in, over the error without."""
    before = after = 0.0
    for part in unseen:
        rows = shape.rows(part.course, scene.unit)
        added = free_response(part.signals, part.anew, part.course, structure.noise, rows, shape.entry)
        found = missing.sizes @ added + missing.moves @ part.slopes
        before += float(np.sum(part.errors[part.judged] ** 2))
        after += float(np.sum((part.errors - found)[part.judged] ** 2))
    return float(np.sqrt(after / before)) if before > 0.0 and np.isfinite(after) else 1.0
