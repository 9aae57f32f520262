"""The stages of one step, in order: what a term may read there, and what becomes of its value.

A step of `step_s` seconds solves, for the speed at its end,

    inertia · (after - before) / step_s = torque - damping · (before + after) / 2 - dry friction

The drive (motor or applied force) and every term add to `torque` and `damping`. Dry friction is an impulse against
the motion, clipped so that at most it stops the motion: sticking is exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, final

from nxt_twin.physics.effect import Stage

Combine = Literal["add", "take", "replace", "states", "density", "hold", "motion", "shift"]


@final
@dataclass(frozen=True)
class StageRule:
    """How a stage works.

    Attributes:
        combine: `add` sums the terms' values; `take` subtracts them; `replace` hands the quantity through each
            term in turn; `states` gives the effect's new states; `density` sums probability densities;
            `hold` gives a torque that opposes the motion and its growth with the step's mean speed, in the place
            of clipped friction; `motion` gives angle and speed anew; `shift` sums pairs, for angle and speed.
        quantity: the local that the stage forms; a `replace` term takes it as argument.
        reads: names of quantities that a term may take as arguments, all SI.
    """

    combine: Combine
    quantity: str
    reads: tuple[str, ...]


_OTHERS = ("others_a", "others_s")
_DRIVE = ("duty", "mode", "elapsed_s", "speed", "current", *_OTHERS)
_MOTION = ("angle", "speed", "step_s", "elapsed_s", "session_s", "inertia", "duty", "current")
_FRICTION = ("level", "direction", "drive_torque", "load_torque", *_MOTION)

STAGES: dict[Stage, StageRule] = {
    "delay": StageRule("add", "delay_s", ()),
    "pace": StageRule("add", "pace", ()),
    "lag": StageRule("take", "target", ("stamp_s", "shown_s", "unseen_s", "late")),
    "commanded": StageRule("take", "acts", ("stamp_s", "late", "longer_after_s", "longer_before_s")),
    "goal": StageRule("replace", "goal", ("goal", "angle", "speed", "step_s", "elapsed_s")),
    "duty": StageRule("replace", "duty", ("duty", "elapsed_s", "held", "angle", "mode")),
    "supply": StageRule("replace", "supply_v", ("supply_v", "elapsed_s", *_OTHERS)),
    "inertia": StageRule("add", "inertia", ("elapsed_s", "session_s", "step_s")),
    "resistance": StageRule("add", "resistance", ("resistance", *_DRIVE)),
    "inductance": StageRule("add", "inductance", _DRIVE),
    "drop": StageRule("add", "drop", _DRIVE),
    "knee": StageRule("add", "knee", _DRIVE),
    "limit": StageRule("replace", "limit", ("limit", *_DRIVE)),
    "damping": StageRule("add", "damping", ("home", *_MOTION)),
    "torque": StageRule("add", "load_torque", ("drive_torque", "home", *_MOTION)),
    "friction": StageRule("replace", "level", _FRICTION),
    "lean": StageRule("replace", "level", _FRICTION),
    "borne": StageRule("add", "borne", _FRICTION),
    "hold": StageRule("hold", "", _FRICTION),
    "creep": StageRule("replace", "after", ("after", "free", "bite")),
    "advance": StageRule("states", "", ("before", "after", "resistance", "held", "mode", "dry", *_MOTION)),
    "stop": StageRule("motion", "", ("angle", "speed", "home")),
    "reading": StageRule("shift", "", ("angle", "speed")),
    "scatter": StageRule("add", "scatter", ("angle", "speed", "unseen_s", "late_open")),
    "outlier": StageRule("density", "outlier", ("reading", "predicted", "last_reading", "reading_std")),
}
"""`angle` is that of the middle of the step (of its end in `stop`, `reading` and `scatter`), `speed` that of its
beginning. Friction `level` is the torque at which dry friction holds or brakes; `direction` is the sign of the motion
it opposes. A `lean` term sees the level that all `friction` terms have made, `dry`. A `borne` term takes from that what
a second body bears; two bodies may bear more than there is, and leave the motor none. `after` is the speed at the
step's end, `free` what it is without dry friction, and `bite` what that takes from it while it slides. `mode` is the
bridge's, as `base.dc_motor` numbers them. `knee` is the current at which half of the drop is there, `limit` bounds the
current. `others_a` is what the brick's other motors draw from the open-circuit supply, `others_s` by how much less for
each volt that it falls; both are 0 where they are at rest or were not recorded. `pace` is how fast the stamps' clock
runs, `lag` how late a reading's stamp is, `commanded` how late a command's, `stamp_s` that stamp. `shown_s`,
`unseen_s`, `late` and `late_open` are what `Signals.ages` has of a reading, or `Signals.command_late` of a command.
`longer_after_s` and `longer_before_s` are what `Signals.command_polls` has. `elapsed_s` is the step's since the
recording began, `session_s` when that was in the session. `held` is the command in force, which a servo's `goal` terms
turn into what its loop follows. `home` is the angle at which the run began. A `reading` term says how far the encoder
is off, a `scatter` term by which variance a reading strays, beyond its ordinary noise."""
