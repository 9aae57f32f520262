"""All numbers of a true motor; a term whose number is zero is absent."""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass, fields
from typing import Final, cast, final

import numpy as np

NEVER_S: Final = 1e9


@final
@dataclass(frozen=True)
class Motor:
    """One motor with its battery, gear train and load; angles are those of the output hub.

    The first block is the plain motor, each further block an effect, off by default. Numbers without a
    unit in their name are ratios, counts or exponents.
    """

    resistance_ohm: float = 7.6
    inductance_h: float = 4.88e-3
    torque_constant_nm_per_a: float = 0.4908
    back_emf_v_s_per_rad: float = 0.4908
    viscous_friction_nm_s_per_rad: float = 1.92e-3
    inertia_kg_m2: float = 1.2e-3
    battery_v: float = 8.0

    # Dry friction: bristles that yield at the level reached in each direction.
    coulomb_forward_nm: float = 8.45e-3
    coulomb_reverse_nm: float = 8.45e-3
    bristle_reach_rad: float = math.radians(0.05)
    bristle_exponent: float = 2.0
    bristle_damping_ratio: float = 0.7
    bristle_damping_speed_rad_s: float = 0.05

    stiction_excess_nm: float = 0.0
    stribeck_speed_rad_s: float = 1.0
    stribeck_exponent: float = 1.0  # zero: Lorentzian
    friction_per_torque: float = 0.0
    cold_extra_torque_nm: float = 0.0
    warmup_time_s: float = 1.0
    binding_torque_nm: float = 0.0
    binding_cycles: float = 1.0
    binding_phase_rad: float = 0.0
    binding_sharpness: float = 1.0
    quadratic_drag_nm_s2_per_rad2: float = 0.0

    constant_torque_nm: float = 0.0
    arm_mass_kg: float = 0.0
    arm_length_m: float = 0.1
    arm_phase_rad: float = 0.0
    band_stiffness_nm_per_rad: float = 0.0
    band_rest_rad: float = 0.0
    cogging_torque_nm: float = 0.0
    cogging_cycles: float = 1.0
    cogging_phase_rad: float = 0.0
    added_inertia_kg_m2: float = 0.0
    added_from_s: float = NEVER_S
    stop_side: float = 0.0  # +1: the angle stays below stop_rad; -1: above
    stop_rad: float = 0.0
    stop_stiffness_nm_per_rad: float = 3000.0
    stop_softness_rad: float = 0.01

    load_inertia_kg_m2: float = 0.0
    load_drag_nm_s_per_rad: float = 0.0
    gap_rad: float = 0.0  # zero: the load hangs on a spring without play
    contact_nm_per_rad15: float = 5000.0
    contact_loss_s_per_rad: float = 0.25
    shaft_stiffness_nm_per_rad: float = 0.0
    shaft_damping_nm_s_per_rad: float = 0.0

    internal_resistance_ohm: float = 0.0
    drain_v_per_s: float = 0.0
    resistance_rise_per_joule: float = 0.0
    thermal_time_s: float = 60.0
    current_limit_a: float = 0.0
    drop_v: float = 0.0
    power_exponent: float = 1.0

    lost_fraction: float = 0.0
    lost_above_rad_s: float = 0.0

    surprise: float = 0.0  # which of the effects in nobody's library, see surprises.py
    surprise_a: float = 0.0
    surprise_b: float = 0.0
    surprise_c: float = 0.0
    surprise_d: float = 0.0


RECORD_TYPE: Final = np.dtype([(field.name, np.float64) for field in fields(Motor)])


def as_record(motor: Motor) -> Motor:
    """The motor as the record that the compiled functions read; it has the same fields."""
    return cast("Motor", np.array([astuple(motor)], dtype=RECORD_TYPE)[0])
