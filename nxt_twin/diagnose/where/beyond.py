"""How much a free function would explain beside the effects that were found.

A near relative of the missing law takes most of the error away, as quadratic drag does for a brake that bites above
a speed. The rest still goes with speed, angle, time or command, so that a free function of those makes the fitted
readings likelier.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from nxt_twin.diagnose.fitting.linear import Linear
from nxt_twin.diagnose.judging.evidence import Evidence
from nxt_twin.diagnose.where.rested import RESTED
from nxt_twin.diagnose.where.setting_in import kin_of
from nxt_twin.diagnose.where.shapes import ShapeFamily
from nxt_twin.diagnose.where.sober import heard, sober_nats
from nxt_twin.diagnose.where.staged import Staged, staged
from nxt_twin.physics.simulate import Simulator


def with_shapes(simulator: Simulator, evidence: Evidence) -> Evidence:
    """`evidence` whose record also tells what a shape explains beside the found effects, where this is asked."""
    if not evidence.record.found:
        return evidence
    nats = sober_nats(simulator, evidence.problem, evidence.final)
    evidence = replace(evidence, record=replace(evidence.record, sober_nats=nats))
    return evidence if evidence.record.by_windows else _with_kin(simulator, evidence)


def _with_kin(simulator: Simulator, evidence: Evidence) -> Evidence:
    """`evidence` whose record also tells what near relatives of the found effects explain."""
    scene = staged(simulator, evidence.problem, evidence.linear)
    found = [effect for effect, _ in evidence.explanation.found]
    kin = [shape for effect in found for shape in kin_of(effect)]
    torques = all(effect.equation_of == "torque_balance" and not effect.states for effect in found)
    slow = any("low_speed" in effect.shows and "angle" not in effect.shows for effect in found)
    record = replace(
        evidence.record,
        rested_nats=_most_nats(scene, evidence.linear, RESTED if torques and slow else ()),
        kin_nats=_most_nats(scene, evidence.linear, kin),
    )
    return replace(evidence, record=record)


def _most_nats(scene: Staged, linear: Linear, shapes: Iterable[ShapeFamily]) -> float:
    return max((heard(scene, linear, shape) for shape in shapes), default=0.0)
