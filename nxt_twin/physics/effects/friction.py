"""Dry and viscous friction of the axis and its gear train."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.inline import exponential, power
from nxt_twin.physics.parameter import DAMPING, DRAG, NUMBER, SPEED, TORQUE, Parameter

if TYPE_CHECKING:
    from nxt_twin.physics.signals import Signals

_FEWEST: Final = 2  # readings that tell of a way
_NEWTON: Final = 7  # steps to the speed of a creep, to 2 % where friction outweighs the body 5000 times


def _coulomb(level: float, coulomb: float) -> float:
    return level + coulomb


COULOMB_FRICTION = Effect(
    id="coulomb_friction",
    name="Coulomb friction",
    equation="τ = -Tc·sign(ω), holding up to Tc at rest",
    source="Gonçalves et al., equation 4",
    equation_of="torque_balance",
    shows=("low_speed", "reversal", "direction"),
    parameters=(
        Parameter(
            "coulomb_friction_nm",
            "coulomb",
            "N·m",
            TORQUE,
            (0.02, 0.06),
            0.0,
            3.0,
            doubt=1.0,
            elsewhere={"rotary": ("coulomb_friction", "N·m"), "linear": ("coulomb_friction", "N")},
        ),
    ),
    terms={"friction": _coulomb},
    confusable_with={
        "voltage_drop": "both leave a dead zone; a coast-down without current shows friction alone",
        "stiction": "slow ramps through zero show the extra breakaway",
    },
    plain=True,
)


def _viscous(viscous: float) -> float:
    return viscous


VISCOUS_FRICTION = Effect(
    id="viscous_friction",
    name="viscous friction",
    equation="τ = -B·ω",
    source="Gonçalves et al., equation 7",
    equation_of="torque_balance",
    shows=("high_speed",),
    parameters=(
        Parameter(
            "viscous_friction_nm_s_per_rad",
            "viscous",
            "N·m·s/rad",
            DAMPING,
            (2e-3, 6e-3),
            0.0,
            1.0,
            doubt=0.5,
            elsewhere={
                "rotary": ("viscous_friction", "N·m·s/rad"),
                "linear": ("viscous_friction", "N·s/m"),
            },
        ),
    ),
    terms={"damping": _viscous},
    confusable_with={
        "quadratic_drag": "steady speeds over a wide range bend with drag and not with viscosity"
    },
    plain=True,
)


def _mean(level: float, forward: float, reverse: float) -> float:
    return level + 0.5 * (forward + reverse)


def _lean(level: float, direction: float, forward: float, reverse: float) -> float:
    """After all other friction, since the excess of stiction is alike both ways."""
    return level + 0.5 * direction * (forward - reverse)


ASYMMETRIC_FRICTION = Effect(
    id="asymmetric_friction",
    name="asymmetric friction",
    equation="τ = -T₊ for ω > 0, +T₋ for ω < 0",
    source="Armstrong-Hélouvry, Dupont and Canudas de Wit 1994, a survey",
    equation_of="torque_balance",
    shows=("direction", "low_speed"),
    notable=0.001,
    parameters=(
        Parameter(
            "coulomb_forward_nm",
            "forward",
            "N·m",
            TORQUE,
            (0.03, 0.01),
            0.0,
            3.0,
            elsewhere={"rotary": ("coulomb_forward_nm", "N·m"), "linear": ("coulomb_forward_n", "N")},
        ),
        Parameter(
            "coulomb_reverse_nm",
            "reverse",
            "N·m",
            TORQUE,
            (0.01, 0.03),
            0.0,
            3.0,
            elsewhere={"rotary": ("coulomb_reverse_nm", "N·m"), "linear": ("coulomb_reverse_n", "N")},
        ),
    ),
    terms={"friction": _mean, "lean": _lean},
    confusable_with={
        "constant_load": "a rest at small commands both ways: a load still pushes there, friction does not"
    },
    supersedes=("coulomb_friction",),
)


def _asymmetric_viscous(speed: float, viscous_forward: float, viscous_reverse: float) -> float:
    return viscous_forward if speed > 0.0 else viscous_reverse


ASYMMETRIC_VISCOUS_FRICTION = Effect(
    id="asymmetric_viscous_friction",
    name="asymmetric viscous friction",
    equation="τ = -B₊·ω for ω > 0, -B₋·ω for ω < 0",
    source="the same survey; a slope of its own for each direction",
    equation_of="torque_balance",
    shows=("direction", "high_speed"),
    notable=3e-4,
    parameters=(
        Parameter(
            "viscous_forward_nm_s_per_rad",
            "viscous_forward",
            "N·m·s/rad",
            DAMPING,
            (4e-3, 1e-3),
            0.0,
            1.0,
            elsewhere={"linear": ("viscous_forward_n_s_per_m", "N·s/m")},
        ),
        Parameter(
            "viscous_reverse_nm_s_per_rad",
            "viscous_reverse",
            "N·m·s/rad",
            DAMPING,
            (1e-3, 4e-3),
            0.0,
            1.0,
            elsewhere={"linear": ("viscous_reverse_n_s_per_m", "N·s/m")},
        ),
    ),
    terms={"damping": _asymmetric_viscous},
    confusable_with={
        "constant_load": "steady speeds of several sizes, both ways, tell a slope from an offset"
    },
    supersedes=("viscous_friction",),
)


def _stribeck(
    level: float, speed: float, breakaway: float, stribeck_speed: float, stribeck_exponent: float
) -> float:
    faded = exponential(
        -power(abs(speed) / stribeck_speed, stribeck_exponent)
    )  # without a branch: lanes go abreast
    return level + max(0.0, breakaway - level) * faded


STICTION = Effect(
    id="stiction",
    name="Stribeck stiction",
    equation="|τ| = Tc + (Ts - Tc)·exp(-(|ω|/ωs)^δ), Ts at rest",
    source="Armstrong-Hélouvry, Dupont and Canudas de Wit 1994, a survey, with exponents δ from 0.5 to 2",
    equation_of="torque_balance",
    shows=("low_speed", "reversal"),
    notable=0.001,
    parameters=(
        Parameter(
            "breakaway_torque_nm",
            "breakaway",
            "N·m",
            TORQUE,
            (0.06, 0.12, 0.03),
            0.0,
            3.0,
            elsewhere={"linear": ("breakaway_force_n", "N")},
            law=0.2,  # contacts that bend first hide a part of the peak where the motion turns back quickly
            above=("coulomb_friction", "coulomb"),
        ),
        Parameter(
            "stribeck_speed_rad_s",
            "stribeck_speed",
            "rad/s",
            SPEED,
            (1.0, 0.3, 3.0),
            0.03,
            10.0,
            spread=1.0,
            elsewhere={"linear": ("stribeck_speed_m_s", "m/s")},
            law=0.2,  # some laws name the speed at which the excess has halved, others that at which 1/e is left
        ),
        Parameter(
            "stribeck_exponent",
            "stribeck_exponent",
            "1",
            NUMBER,
            (1.5,),
            0.5,
            2.0,
            spread=0.3,
            otherwise=2.0,
        ),
    ),
    terms={"friction": _stribeck},
    confusable_with={"coulomb_friction": "slow ramps through zero, both ways, show the drop after breakaway"},
)


def _crept(after: float, free: float, bite: float, creep_speed: float) -> float:
    """By backward Euler, so that a slow creep keeps its speed however long the step is.

    Newton's method from the larger of two speeds that lie below the solution. It stays there, as the law is concave.
    """
    if creep_speed <= 0.0 or bite <= 0.0:
        return after
    found = max(abs(free) / (1.0 + bite / creep_speed), abs(free) - bite)
    for _ in range(_NEWTON):
        share = 1.0 - 2.0 / (exponential(2.0 * found / creep_speed) + 1.0)
        slope = 1.0 + bite / creep_speed * (1.0 - share * share)
        found -= (found + bite * share - abs(free)) / slope
    return math.copysign(found, free)


FRICTION_CREEP = Effect(
    id="friction_creep",
    name="friction creep",
    equation="τ = -Tc·tanh(ω/ωc), in the place of sticking",
    source="a lubricated contact; smoothed Coulomb friction, as many simulators have it",
    equation_of="torque_balance",
    shows=("low_speed",),
    notable=2.0,
    parameters=(
        Parameter(
            "creep_speed_rad_s",
            "creep_speed",
            "rad/s",
            SPEED,
            (0.05,),
            1e-3,
            5.0,
            spread=3.0,
            elsewhere={"linear": ("creep_speed_m_s", "m/s")},
        ),
    ),
    terms={"creep": _crept},
    confusable_with={
        "presliding": "a pause without drive after a push tells: bent bristles spring back, creep stays where it is"
    },
)


def _load_dependent(level: float, drive_torque: float, load_torque: float, per_torque: float) -> float:
    return level + per_torque * max(abs(drive_torque), abs(load_torque))


LOAD_DEPENDENT_FRICTION = Effect(
    id="load_dependent_friction",
    name="load-dependent friction",
    equation="|τ| = Tc + k·|τ carried|, the larger of drive and load",
    source="Duclusaud et al. 2024, models M3 to M6",
    equation_of="torque_balance",
    shows=("high_current", "after_command"),
    notable=0.02,
    parameters=(
        Parameter(
            "friction_per_torque",
            "per_torque",
            "1",
            NUMBER,
            (0.1, 0.3),
            0.0,
            0.9,
            elsewhere={"linear": ("friction_per_force", "1")},
            law=0.05,  # a train between drive and load may carry somewhat more than the larger of the two
        ),
    ),
    terms={"friction": _load_dependent},
    confusable_with={
        "battery_sag": "fast battery readings at high current tell: friction leaves the supply alone",
        "voltage_drop": "small commands held at rest tell a dead zone in voltage from one in torque",
    },
)


def _drag(speed: float, drag: float) -> float:
    return drag * abs(speed)


QUADRATIC_DRAG = Effect(
    id="quadratic_drag",
    name="quadratic drag",
    equation="τ = -c·ω·|ω|",
    source="drag at high Reynolds numbers: a fan, a paddle",
    equation_of="torque_balance",
    shows=("high_speed",),
    notable=1.2e-05,
    parameters=(
        Parameter(
            "quadratic_drag_nm_s2_per_rad2",
            "drag",
            "N·m·s²/rad²",
            DRAG,
            (4e-4, 2e-3),
            0.0,
            0.1,
            elsewhere={"linear": ("quadratic_drag_n_s2_per_m2", "N·s²/m²")},
        ),
    ),
    terms={"damping": _drag},
    confusable_with={"viscous_friction": "steady speeds over a wide range, and long coast-downs"},
)


def _warmup(level: float, run_in: float, cold_extra: float, time_constant: float) -> float:
    return level + cold_extra * exponential(-run_in / time_constant)


def _run_in(
    run_in: float, before: float, after: float, step_s: float, motion_share: float, warming_speed: float
) -> float:
    """For how long it has run in, s: time counts, and so does the way."""
    return run_in + step_s * (1.0 - motion_share + motion_share * abs(0.5 * (before + after)) / warming_speed)


def _mean_speeds(recordings: Sequence[Signals]) -> list[float]:
    """The mean speed of all recordings, at which time and way count alike."""
    way = length_s = 0.0
    for signals in recordings:
        read = np.isfinite(signals.measured)
        seen, at_s = signals.measured[read], signals.time_s[read]
        if at_s.size < _FEWEST:
            continue
        way += float(np.sum(np.abs(seen[1:]) * np.diff(at_s) if signals.is_speed else np.abs(np.diff(seen))))
        length_s += float(at_s[-1] - at_s[0])
    return [way / length_s] if way > 0.0 else []


FRICTION_WARMUP = Effect(
    id="friction_warmup",
    name="friction warm-up",
    equation="|τ| = Tc + Tw·exp(-a/tw), da/dt = 1 - p + p·|ω|/ωw, a = 0 where the recording begins",
    source="Bittencourt et al. 2010 on how gear friction falls as it warms; one time constant, by time or by the way",
    equation_of="torque_balance",
    shows=("elapsed_time",),
    notable=0.0012,
    parameters=(
        Parameter(
            "cold_extra_torque_nm",
            "cold_extra",
            "N·m",
            TORQUE,
            (0.02, 0.06),
            0.0,
            3.0,
            elsewhere={"linear": ("cold_extra_force_n", "N")},
        ),
        Parameter("time_constant_s", "time_constant", "s", NUMBER, (5.0, 20.0, 2.0), 0.5, 300.0, spread=3.0),
        Parameter(
            "motion_share", "motion_share", "1", NUMBER, (0.0,), 0.0, 1.0, 1.0, otherwise=0.0, shared_out=True
        ),
        Parameter(
            "warming_speed_rad_s",
            "warming_speed",
            "rad/s",
            SPEED,
            (5.0,),
            1e-3,
            1e3,
            elsewhere={"linear": ("warming_speed_m_s", "m/s")},
            otherwise=5.0,
            hints=_mean_speeds,
            tried=True,
        ),
    ),
    terms={"friction": _warmup, "advance": _run_in},
    states=("run_in",),
    lasting=("run_in",),
    confusable_with={"battery_sag": "a rest and a second run tell: what has run in stays so"},
)
