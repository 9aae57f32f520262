"""A load inertia behind play or a shaft that twists.

Both integrate the load by the trapezoidal rule. They give the motor the reaction as a torque and a damping. The step
so solves the coupling together with the motor's speed, and stays stable at any stiffness.
"""

from __future__ import annotations

import math

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.parameter import ANGLE, INERTIA, NUMBER, STIFFNESS, Parameter

_CONTACT_RATE_PER_S = 500.0  # how stiff the flanks of a gap are: a contact settles in about 2 ms


def _reaction(
    stretch: float,
    load_speed: float,
    stiffness: float,
    damping: float,
    load_inertia: float,
    step_s: float,
) -> tuple[float, float]:
    """Torque on the load at zero motor speed, and its growth with the motor's mean speed over the step."""
    grip = damping + stiffness * step_s / 2.0
    yielding = 1.0 + grip * step_s / (2.0 * load_inertia)
    return (stiffness * stretch - grip * load_speed) / yielding, grip / yielding


def _borne(level: float, load_friction_share: float) -> float:
    return max(load_friction_share, 0.0) * level  # a slope may look beyond none


def _rubbed(load_speed: float, pushed: float, rubs: float, load_inertia: float, step_s: float) -> float:
    """Speed of the load after a step under the torque `pushed`, braked by dry friction that at most stops it."""
    free = load_speed + step_s * pushed / load_inertia
    slowing = step_s * rubs / load_inertia
    return free - min(max(free, -slowing), slowing)


def _contact(
    play: float, load_speed: float, speed: float, gap: float, load_inertia: float, step_s: float
) -> tuple[float, float]:
    half = gap / 2.0
    if abs(play) <= half:
        return 0.0, 0.0
    stretch = play - math.copysign(half, play)
    stiffness = load_inertia * _CONTACT_RATE_PER_S**2
    damping = 2.0 * load_inertia * _CONTACT_RATE_PER_S
    if (stiffness * stretch + damping * (speed - load_speed)) * stretch <= 0.0:
        return 0.0, 0.0
    return _reaction(stretch, load_speed, stiffness, damping, load_inertia, step_s)


def _backlash_torque(
    play: float, play_load_speed: float, speed: float, gap: float, load_inertia: float, step_s: float
) -> float:
    return -_contact(play, play_load_speed, speed, gap, load_inertia, step_s)[0]


def _backlash_damping(
    play: float, play_load_speed: float, speed: float, gap: float, load_inertia: float, step_s: float
) -> float:
    return _contact(play, play_load_speed, speed, gap, load_inertia, step_s)[1]


def _backlash_advance(
    play: float,
    play_load_speed: float,
    before: float,
    after: float,
    dry: float,
    gap: float,
    load_inertia: float,
    load_friction_share: float,
    step_s: float,
) -> tuple[float, float]:
    held, growth = _contact(play, play_load_speed, before, gap, load_inertia, step_s)
    mean = 0.5 * (before + after)
    rubs = _borne(dry, load_friction_share)
    load_after = _rubbed(play_load_speed, held + growth * mean, rubs, load_inertia, step_s)
    return play + step_s * (mean - 0.5 * (play_load_speed + load_after)), load_after


_LOAD_INERTIA = Parameter(
    "load_inertia_kg_m2",
    "load_inertia",
    "kg·m²",
    INERTIA,
    (5e-4, 1.5e-3),
    2e-5,
    0.2,
    spread=2.0,
    elsewhere={"linear": ("load_mass_kg", "kg")},
)

_LOAD_FRICTION_SHARE = Parameter(
    "load_friction_share",
    "load_friction_share",
    "1",
    NUMBER,
    (0.2,),
    0.0,
    1.0,
    spread=1.5,
    otherwise=0.0,
    shared_out=True,
)
"""Of the dry friction; where the load bears it, it rests in its play while the motor crosses that."""

BACKLASH = Effect(
    id="backlash",
    name="backlash",
    equation="load free within ±gap/2 of the hub, stiff and inelastic contact beyond; it bears a share of the friction",
    source="the dead-zone model of Nordin and Gutman 2002, flanks critically damped",
    equation_of="torque_balance",
    shows=("reversal", "after_command"),
    notable=0.8,
    parameters=(
        Parameter(
            "gap_deg",
            "gap",
            "deg",
            ANGLE,
            (6.0, 13.0, 2.5),
            0.1,
            60.0,
            spread=2.0,
            si=math.pi / 180.0,
            elsewhere={"linear": ("gap_mm", "mm", 1e-3)},
            law=0.1,  # flanks that bounce let a load cross its play sooner than flanks that hold it
        ),
        _LOAD_INERTIA,
        _LOAD_FRICTION_SHARE,
    ),
    terms={
        "torque": _backlash_torque,
        "damping": _backlash_damping,
        "borne": _borne,
        "advance": _backlash_advance,
    },
    states=("play", "play_load_speed"),
    moving=("play_load_speed",),
    confusable_with={
        "shaft_compliance": "small reversals tell: play is free, a shaft springs back",
        "command_delay": "a delay acts on every command, play only where the torque changes sign",
    },
)


def _shaft(
    twist: float,
    twist_load_speed: float,
    stiffness: float,
    load_inertia: float,
    damping_ratio: float,
    step_s: float,
) -> tuple[float, float]:
    damping = 2.0 * damping_ratio * math.sqrt(stiffness * load_inertia)
    return _reaction(twist, twist_load_speed, stiffness, damping, load_inertia, step_s)


def _shaft_torque(
    twist: float,
    twist_load_speed: float,
    stiffness: float,
    load_inertia: float,
    damping_ratio: float,
    step_s: float,
) -> float:
    return -_shaft(twist, twist_load_speed, stiffness, load_inertia, damping_ratio, step_s)[0]


def _shaft_damping(
    twist: float,
    twist_load_speed: float,
    stiffness: float,
    load_inertia: float,
    damping_ratio: float,
    step_s: float,
) -> float:
    return _shaft(twist, twist_load_speed, stiffness, load_inertia, damping_ratio, step_s)[1]


def _shaft_advance(
    twist: float,
    twist_load_speed: float,
    before: float,
    after: float,
    dry: float,
    stiffness: float,
    load_inertia: float,
    damping_ratio: float,
    load_friction_share: float,
    step_s: float,
) -> tuple[float, float]:
    held, growth = _shaft(twist, twist_load_speed, stiffness, load_inertia, damping_ratio, step_s)
    mean = 0.5 * (before + after)
    rubs = _borne(dry, load_friction_share)
    load_after = _rubbed(twist_load_speed, held + growth * mean, rubs, load_inertia, step_s)
    return twist + step_s * (mean - 0.5 * (twist_load_speed + load_after)), load_after


SHAFT_COMPLIANCE = Effect(
    id="shaft_compliance",
    name="shaft compliance",
    equation="τ = k·(θ - θL) + c·(ω - ωL), c = 2·D·√(k·JL); the load bears a share of the friction",
    source="two masses on a torsion spring, as in any text on drives",
    equation_of="torque_balance",
    shows=("after_command", "reversal"),
    notable_most=9.0,  # a stiffer one stands for other physics (docs/decisions/0045-fewer-fits-of-lost-counts.md)
    parameters=(
        Parameter(
            "stiffness_nm_per_rad",
            "stiffness",
            "N·m/rad",
            STIFFNESS,
            (0.7, 0.2, 2.0),
            5e-3,
            50.0,
            spread=3.0,
            elsewhere={"linear": ("stiffness_n_per_m", "N/m")},
        ),
        _LOAD_INERTIA,
        Parameter(
            "shaft_damping_ratio",
            "damping_ratio",
            "1",
            NUMBER,
            (0.03,),
            1e-3,
            1.0,
            spread=2.0,
            otherwise=0.03,  # what steel and plastic shafts mostly lose
        ),
        _LOAD_FRICTION_SHARE,
    ),
    terms={
        "torque": _shaft_torque,
        "damping": _shaft_damping,
        "borne": _borne,
        "advance": _shaft_advance,
    },
    states=("twist", "twist_load_speed"),
    moving=("twist_load_speed",),
    confusable_with={"backlash": "small reversals tell: play is free, a shaft springs back"},
)
