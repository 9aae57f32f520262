"""The stages of one step, in order: what a term may read there, and what becomes of its value.

A step of `step_s` seconds solves, for the speed at its end,

    inertia · (after - before) / step_s = torque - damping · (before + after) / 2 - dry friction

where the drive (motor or applied force) and every term add to `torque` and `damping`, and dry friction is an
impulse that opposes motion and is clipped so that it stops it at most: sticking is exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, final

from nxt_twin.physics.effect import Stage

Combine = Literal["add", "replace", "states", "density"]


@final
@dataclass(frozen=True)
class StageRule:
    """How a stage works.

    Attributes:
        combine: `add` sums the terms' values; `replace` hands the quantity through each term in turn;
            `states` gives the effect's new states; `density` sums probability densities.
        quantity: the local that the stage forms; a `replace` term takes it as argument.
        reads: names of quantities that a term may take as arguments, all SI.
    """

    combine: Combine
    quantity: str
    reads: tuple[str, ...]


_DRIVE = ("duty", "elapsed_s", "speed", "current")
_MOTION = ("angle", "speed", "step_s", "elapsed_s", "inertia", "duty", "current")

STAGES: dict[Stage, StageRule] = {
    "delay": StageRule("add", "delay_s", ()),
    "duty": StageRule("replace", "duty", ("duty", "elapsed_s")),
    "resistance": StageRule("add", "resistance", _DRIVE),
    "inductance": StageRule("add", "inductance", _DRIVE),
    "drop": StageRule("add", "drop", _DRIVE),
    "limit": StageRule("replace", "limit", ("limit", *_DRIVE)),
    "damping": StageRule("add", "damping", _MOTION),
    "torque": StageRule("add", "load_torque", _MOTION),
    "friction": StageRule(
        "replace", "level", ("level", "direction", "drive_torque", "load_torque", *_MOTION)
    ),
    "advance": StageRule("states", "", ("before", "after", *_MOTION)),
    "outlier": StageRule("density", "outlier", ("reading", "predicted", "last_reading", "reading_std")),
}
"""`angle` is that of the middle of the step, `speed` that of its beginning. Friction `level` is the torque at which
dry friction holds or brakes; `direction` is the sign of the motion it opposes. `limit` bounds the current."""
