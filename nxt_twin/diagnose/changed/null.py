"""What seems to differ where nothing does, or to help where nothing came in: what a change has to exceed."""

from __future__ import annotations

import math

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.changed.candidates import new_effects, promises
from nxt_twin.diagnose.changed.joint import JointFit, JointFitter
from nxt_twin.diagnose.fitting.losses import SOFT
from nxt_twin.physics.parameter import Scale

_PATTERNS = ((0, 1), (0, 1, 1, 0))
_FEWEST = 2  # recordings of a side: one alone has no repeat


def alarm_nats(fitter: JointFitter, joint: JointFit) -> float | None:
    """The gain of the best single parameter between repeats of one side, where nothing changed; net, nats.

    None where there is one recording alone. Recordings are sorted by how far they move, so that repeats of one motion
    come apart.

    Args:
        fitter: of that side alone.
        joint: its fit.
    """
    side = fitter.sides[0]
    if len(side.jobs) < _FEWEST:
        return None
    slopes = fitter.slopes(joint.model, joint.x, joint.error, "everything")
    hessian, gradient = fitter.normal_equations(joint.model, joint.x, slopes, "everything")
    residual, slope = slopes.residual[0], slopes.slope[0]
    weight = side.weight("everything") / np.sqrt(1.0 + (residual / SOFT) ** 2)
    penalty = 0.5 * math.log(max(fitter.worth("everything"), 2.0))
    ways = joint.model.ways
    most = 0.0
    for later in _splits(fitter):
        for way in ways:
            own = way.of(slope) * later
            column = (slope * weight) @ own
            corner = float(own @ (weight * own)) + way.spread**-2.0
            whole = np.block([[hessian, column[:, None]], [column[None], np.array([[corner]])]])
            pull = np.concatenate([gradient, [-float(own @ (weight * residual))]])
            most = max(most, _fall(whole, pull) - _fall(hessian, gradient) - penalty)
    return most


def lacking_nats(fitter: JointFitter, joint: JointFit, scale: Scale) -> float:
    """The net gain that the best effect of the library promises on the side before alone, where none is a change; nats.

    A model that is inexact lets one law or another help, and under another load it lacks at least as much.

    Args:
        fitter: of that side alone.
        joint: its fit.
        scale: of the plant.
    """
    every = new_effects(fitter, joint.model, scale)
    return max([0.0, *(gain for gain, _ in promises(fitter, joint, every, scale))])


def _splits(fitter: JointFitter) -> list[BoolArray]:
    """Which readings belong to the second part, by split."""
    side = fitter.sides[0]
    moved = [float(np.nanstd(job.signals.measured)) for job in side.jobs]
    place = np.argsort(np.argsort(moved))
    recording = side.recordings("everything")
    return [
        np.array([pattern[n % len(pattern)] for n in place], dtype=bool)[recording] for pattern in _PATTERNS
    ]


def _fall(hessian: FloatArray, gradient: FloatArray) -> float:
    return 0.5 * float(gradient @ np.linalg.lstsq(hessian, gradient, rcond=1e-12)[0])
