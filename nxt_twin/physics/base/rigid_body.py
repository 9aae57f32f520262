"""A rigid body on an axis, driven by a known torque or force."""

from __future__ import annotations

from nxt_twin.physics.base.base import Base
from nxt_twin.physics.parameter import INERTIA, Parameter


def drive(duty: float) -> tuple[float, float]:
    """The applied torque (N·m) or force (N) itself, and no damping."""
    return duty, 0.0


RIGID_BODY = Base(
    kind="rigid_body",
    frames=("rotary", "linear"),
    parameters=(
        Parameter(
            "inertia",
            "inertia",
            "kg·m²",
            INERTIA,
            (1.2e-3,),
            1e-6,
            1.0,
            doubt=1.0,
            elsewhere={"linear": ("inertia", "kg")},
        ),
    ),
    drive=drive,
)
