"""A centrifugal brake: shoes that springs hold back, and that swing out and rub above a speed."""

from __future__ import annotations

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.parameter import DRAG, SPEED, Parameter


def _brake(speed: float, grip: float, engage: float) -> float:
    """The brake's torque over the speed that it opposes, N·m·s/rad: a `damping` term."""
    pace = abs(speed)
    return grip * (pace * pace - engage * engage) / pace if pace > engage else 0.0


CENTRIFUGAL_BRAKE = Effect(
    id="centrifugal_brake",
    name="centrifugal brake",
    equation="τ = -c·(ω² - ωe²)·sign(ω) for |ω| > ωe",
    source="a shoe's centrifugal force less its spring's, times a coefficient of friction",
    equation_of="torque_balance",
    shows=("high_speed",),
    parameters=(
        Parameter(
            name="brake_nm_s2_per_rad2",
            symbol="grip",
            unit="N·m·s²/rad²",
            dimension=DRAG,
            starts=(5e-4,),
            lower=0.0,
            upper=0.1,
            elsewhere={"linear": ("brake_n_s2_per_m2", "N·s²/m²")},
        ),
        Parameter(
            name="engage_speed_rad_s",
            symbol="engage",
            unit="rad/s",
            dimension=SPEED,
            starts=(6.0, 4.0, 9.0, 12.0),
            lower=0.5,
            upper=40.0,
            elsewhere={"linear": ("engage_speed_m_s", "m/s")},
        ),
    ),
    terms={"damping": _brake},
    confusable_with={
        "quadratic_drag": "steady speeds below the one at which the shoes swing out: there only drag brakes"
    },
)
