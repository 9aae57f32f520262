"""Concealed friction."""

from __future__ import annotations

import math

from nxt_twin.blind.effects.concealed import ConcealedEffect, Draw, Situation


def _coulomb_friction(now: Situation) -> Draw:
    level = now.sized((2.5e-3, 5e-3), (8e-3, 14e-3), (20e-3, 35e-3))
    return Draw(
        params={"coulomb_friction_nm": level},
        motor={"coulomb_forward_nm": level, "coulomb_reverse_nm": level},
        absent={"coulomb_forward_nm": 0.0, "coulomb_reverse_nm": 0.0},
    )


def _viscous_friction(now: Situation) -> Draw:
    slope = now.sized((0.6e-3, 1.1e-3), (1.8e-3, 3e-3), (5e-3, 9e-3))
    return Draw(
        params={"viscous_friction_nm_s_per_rad": slope},
        motor={"viscous_friction_nm_s_per_rad": slope},
        absent={"viscous_friction_nm_s_per_rad": 0.0},
    )


def _presliding(now: Situation) -> Draw:
    reach_deg = now.sized((1.5, 2.5), (4.0, 7.0), (10.0, 16.0))
    return Draw(
        params={"presliding_deg": reach_deg},
        motor={
            "bristle_reach_rad": math.radians(reach_deg),
            "bristle_exponent": now.one_of(1.0, 1.5),
            "bristle_damping_ratio": 0.3,
            "bristle_damping_speed_rad_s": 0.5,
        },
    )


def _stiction(now: Situation) -> Draw:
    excess = now.sized((3e-3, 6e-3), (9e-3, 16e-3), (22e-3, 40e-3))
    speed = now.between(0.4, 3.0)
    coulomb = 0.5 * (now.motor.coulomb_forward_nm + now.motor.coulomb_reverse_nm)
    return Draw(
        params={"breakaway_torque_nm": coulomb + excess, "stribeck_speed_rad_s": speed},
        motor={
            "stiction_excess_nm": excess,
            "stribeck_speed_rad_s": speed,
            "stribeck_exponent": now.one_of(0.0, 1.0, 1.5, 2.0),
        },
    )


def _asymmetric_friction(now: Situation) -> Draw:
    half = now.sized((1.5e-3, 2.5e-3), (4e-3, 7e-3), (10e-3, 18e-3))
    mean = max(now.motor.coulomb_forward_nm, 1.2 * half)
    lean = now.sign() * half
    return Draw(
        params={"coulomb_forward_nm": mean + lean, "coulomb_reverse_nm": mean - lean},
        motor={"coulomb_forward_nm": mean + lean, "coulomb_reverse_nm": mean - lean},
        absent={"coulomb_forward_nm": mean, "coulomb_reverse_nm": mean},
    )


def _load_dependent_friction(now: Situation) -> Draw:
    share = now.sized((0.05, 0.08), (0.12, 0.2), (0.3, 0.45))
    return Draw(params={"friction_per_torque": share}, motor={"friction_per_torque": share})


def _quadratic_drag(now: Situation) -> Draw:
    drag = now.sized((4e-5, 8e-5), (1.5e-4, 3e-4), (5e-4, 1e-3))
    return Draw(params={"quadratic_drag_nm_s2_per_rad2": drag}, motor={"quadratic_drag_nm_s2_per_rad2": drag})


def _friction_warmup(now: Situation) -> Draw:
    extra = now.sized((5e-3, 8e-3), (12e-3, 20e-3), (30e-3, 50e-3))
    time_s = now.between(0.15, 0.6) * now.duration_s
    return Draw(
        params={"cold_extra_torque_nm": extra, "time_constant_s": time_s},
        motor={"cold_extra_torque_nm": extra, "warmup_time_s": time_s},
    )


def _angle_dependent_friction(now: Situation) -> Draw:
    torque = now.sized((8e-3, 14e-3), (22e-3, 38e-3), (60e-3, 0.1))
    cycles = now.one_of(1.0, 1.0, 2.0, 3.0)
    return Draw(
        params={"binding_torque_nm": torque, "cycles_per_turn": cycles},
        motor={
            "binding_torque_nm": torque,
            "binding_cycles": cycles,
            "binding_phase_rad": now.angle_rad(),
            "binding_sharpness": now.between(1.0, 4.0),
        },
    )


FRICTION: tuple[ConcealedEffect, ...] = (
    ConcealedEffect(
        "coulomb_friction",
        "torque_balance",
        _coulomb_friction,
        leaves_out="coulomb_friction_nm",
        clashes=("asymmetric_friction",),
    ),
    ConcealedEffect(
        "viscous_friction",
        "torque_balance",
        _viscous_friction,
        leaves_out="viscous_friction_nm_s_per_rad",
        needs_coasting=True,
    ),
    ConcealedEffect("presliding", "torque_balance", _presliding),
    ConcealedEffect(
        "asymmetric_friction", "torque_balance", _asymmetric_friction, clashes=("coulomb_friction",)
    ),
    ConcealedEffect("stiction", "torque_balance", _stiction),
    ConcealedEffect("load_dependent_friction", "torque_balance", _load_dependent_friction),
    ConcealedEffect("quadratic_drag", "torque_balance", _quadratic_drag),
    ConcealedEffect("friction_warmup", "torque_balance", _friction_warmup),
    ConcealedEffect("angle_dependent_friction", "torque_balance", _angle_dependent_friction),
)
