"""Effects of the encoder on the measured angle."""

from __future__ import annotations

import math

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.effects.harmonic import harmonic
from nxt_twin.physics.parameter import NUMBER, SPEED, Parameter

_EDGE = 0.1  # over this share of the threshold the loss sets in, so that a fit can move the threshold


def _lost_share(speed: float, loss: float, threshold: float) -> float:
    above = (abs(speed) - threshold) / (_EDGE * threshold) + 0.5
    return loss * min(max(above, 0.0), 1.0)


def _miscount(speed: float, lost: float, loss: float, threshold: float) -> tuple[float, float]:
    return -lost, -_lost_share(speed, loss, threshold) * speed


def _lose(lost: float, before: float, after: float, step_s: float, loss: float, threshold: float) -> float:
    mean = 0.5 * (before + after)
    return lost + step_s * mean * _lost_share(mean, loss, threshold)


MISSED_COUNTS = Effect(
    id="missed_counts",
    name="missed counts",
    equation="reading = θ - ∫p·ω·[|ω| > ωm] dt",
    source="our own: a counter that misses a share p of the edges above a speed ωm",
    equation_of="measurement",
    shows=("high_speed",),
    notable=0.005,
    parameters=(
        Parameter("loss_fraction", "loss", "1", NUMBER, (0.05, 0.15), 0.0, 0.95),
        Parameter(
            "speed_threshold_rad_s",
            "threshold",
            "rad/s",
            SPEED,
            (5.0, 4.0, 6.5, 8.0, 10.0),
            0.5,
            40.0,
            elsewhere={"linear": ("speed_threshold_m_s", "m/s")},
            law=0.2 * _EDGE,  # a counter may begin to lose more suddenly, or less
        ),
    ),
    terms={"reading": _miscount, "advance": _lose},
    states=("lost",),
    counted=True,
    confusable_with={
        "quadratic_drag": "a mark on the hub tells after a fast run: lost counts leave it displaced, drag does not",
        "viscous_friction": "coasting down tells: the loss ends at a speed, friction goes on",
    },
)


def _eccentric(
    angle: float,
    speed: float,
    amplitude: float,
    cycles: float,
    phase: float,
    in_phase: float,
    in_quadrature: float,
) -> tuple[float, float]:
    turn = cycles * angle + phase
    along, across = math.sin(turn), math.cos(turn)
    twice_along, twice_across = 2.0 * along * across, across * across - along * along
    off = along + in_phase * twice_along + in_quadrature * twice_across
    slope = across + 2.0 * (in_phase * twice_across - in_quadrature * twice_along)
    return amplitude * off, amplitude * cycles * speed * slope


ENCODER_ECCENTRICITY = Effect(
    id="encoder_eccentricity",
    name="encoder eccentricity",
    equation="reading = θ + A·(sin x + a·sin 2x + b·cos 2x), x = n·θ + φ",
    source="geometry: a disc off its centre by a, read at radius r, errs by a/r·sin; a tilted one twice as often, too",
    equation_of="measurement",
    shows=("angle", "high_speed"),
    notable=0.25,
    parameters=(
        # A disc is as far off its centre on a quick motor as on a slow one.
        Parameter("amplitude_deg", "amplitude", "deg", NUMBER, (2.0,), 0.0, 45.0, si=math.pi / 180.0),
        Parameter("cycles_per_turn", "cycles", "1", NUMBER, (1.0, 2.0, 3.0, 4.0, 6.0), 0.5, 60.0),
        Parameter(
            "phase_deg",
            "phase",
            "deg",
            NUMBER,
            (0.0, 120.0, -120.0),
            -360.0,
            360.0,
            si=math.pi / 180.0,
            otherwise=0.0,
        ),
        harmonic("harmonic_in_phase", "in_phase"),
        harmonic("harmonic_in_quadrature", "in_quadrature"),
    ),
    terms={"reading": _eccentric},
    confusable_with={
        "gravity_load": "the same turns at several speeds tell: a torque fades with speed, a reading does not",
        "cogging": "the same turns at several speeds tell: a torque fades with speed, a reading does not",
        "angle_dependent_friction": "the same turns at several speeds tell: a torque fades with speed",
    },
    frames=("motor", "rotary"),
)
