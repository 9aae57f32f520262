"""Friction that differs as from run to run: no change, and nothing unexplained either."""

from __future__ import annotations

from nxt_twin.diagnose.changed.joint import JointFit, JointFitter
from nxt_twin.diagnose.changed.weighing import FRICTION, is_drift


def with_drift(fitter: JointFitter, joint: JointFit) -> JointFit:
    """`joint`, or what is likelier where its friction differs by no more than from run to run."""
    ways = enumerate(joint.model.ways)
    rubbing = [n for n, way in ways if way.slot.symbol in FRICTION and n not in joint.model.differs]
    best = joint
    for n in rubbing:
        model = joint.model.differing([n])
        tried = fitter.fit(model, model.moved_from(joint.model, joint.x))
        if tried.cost < best.cost and is_drift(tried, n):
            best = tried
    return best
