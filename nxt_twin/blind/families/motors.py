"""The motors that are on the bench: of several makes, none as its plant file says."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.random import Generator

from nxt_twin.blind.families.numbers import Numbers

SPREAD: Final = 0.2
"""By how much a baseline's number may be off, either way."""

_MAKES: Final = (
    # ohm, H, N·m/A, N·m·s/rad, kg·m², V, N·m
    (7.6, 4.88e-3, 0.4908, 1.92e-3, 1.2e-3, 8.0, 8.45e-3),
    (7.6, 4.88e-3, 0.4908, 1.92e-3, 1.2e-3, 8.0, 8.45e-3),
    (6.8, 5.0e-3, 0.41, 1.1e-3, 2.2e-3, 7.6, 1.4e-2),
    (4.4, 2.5e-3, 0.29, 0.9e-3, 0.7e-3, 7.2, 1.0e-2),
    (10.5, 8.0e-3, 0.62, 3.0e-3, 2.0e-3, 9.0, 2.2e-2),
)


def draw_motor(rng: Generator) -> Numbers:
    """One of the makes, each number within 20 % of its make's, the battery within 6 %."""
    make = _MAKES[int(rng.integers(len(_MAKES)))]
    ohm, henry, constant, viscous, inertia, supply, coulomb = make
    off = 1.0 + rng.uniform(-SPREAD, SPREAD, 6)
    return Numbers(
        resistance_ohm=ohm * float(off[0]),
        inductance_h=henry * float(off[1]),
        torque_constant_nm_per_a=constant * float(off[2]),
        viscous_friction_nm_s_per_rad=viscous * float(off[3]),
        inertia_kg_m2=inertia * float(off[4]),
        supply_v=supply * float(1.0 + rng.uniform(-0.06, 0.06)),
        coulomb_forward_nm=coulomb * float(off[5]),
        coulomb_reverse_nm=coulomb * float(off[5]),
        seed=float(rng.integers(2**31)),
    )


def true_parameters(motor: Numbers) -> dict[str, float]:
    """The true values of the keys of a `dc_motor` baseline."""
    return {
        "resistance_ohm": motor.resistance_ohm,
        "inductance_h": motor.inductance_h,
        "torque_constant_nm_per_a": motor.torque_constant_nm_per_a,
        "back_emf_v_s_per_rad": motor.torque_constant_nm_per_a,
        "coulomb_friction_nm": motor.coulomb_nm,
        "viscous_friction_nm_s_per_rad": motor.viscous_friction_nm_s_per_rad,
        "inertia_kg_m2": motor.inertia_kg_m2,
        "supply_v": motor.supply_v,
    }


def draw_baseline(rng: Generator, motor: Numbers) -> dict[str, float]:
    """Parameters for the plant file: each true one times 0.8 to 1.2, one factor for both constants; supply ± 4 %."""
    true = true_parameters(motor)
    off = {key: float(1.0 + rng.uniform(-SPREAD, SPREAD)) for key in true}
    off["back_emf_v_s_per_rad"] = off["torque_constant_nm_per_a"]
    off["supply_v"] = float(1.0 + rng.uniform(-0.04, 0.04))
    return {
        key: float(np.format_float_positional(value * off[key], 4, fractional=False))
        for key, value in true.items()
    }
