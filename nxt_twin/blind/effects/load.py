"""Concealed loads, limits and second inertias."""

from __future__ import annotations

import math

from nxt_twin.blind.effects.concealed import ConcealedEffect, Draw, Situation
from nxt_twin.blind.truth.load import GRAVITY_M_PER_S2
from nxt_twin.blind.truth.motor import NEVER_S


def _backlash(now: Situation) -> Draw:
    gap_deg = now.sized((1.5, 3.0), (4.0, 7.0), (10.0, 16.0))
    inertia = now.sized((4e-4, 6e-4), (7e-4, 1.1e-3), (1.3e-3, 2.2e-3))
    return Draw(
        params={"gap_deg": gap_deg, "load_inertia_kg_m2": inertia},
        motor={
            "gap_rad": math.radians(gap_deg),
            "load_inertia_kg_m2": inertia,
            "load_drag_nm_s_per_rad": inertia / now.between(10.0, 30.0),
            "contact_nm_per_rad15": now.between(3000.0, 8000.0),
        },
    )


def _shaft_compliance(now: Situation) -> Draw:
    inertia = now.sized((3e-4, 5e-4), (6e-4, 1e-3), (1.2e-3, 2e-3))
    frequency_hz = now.sized((9.0, 14.0), (5.0, 8.0), (2.2, 4.0))
    stiffness = inertia * (2.0 * math.pi * frequency_hz) ** 2
    damping = 2.0 * now.between(0.03, 0.1) * math.sqrt(stiffness * inertia)
    return Draw(
        params={"stiffness_nm_per_rad": stiffness, "load_inertia_kg_m2": inertia},
        motor={
            "load_inertia_kg_m2": inertia,
            "shaft_stiffness_nm_per_rad": stiffness,
            "shaft_damping_nm_s_per_rad": damping,
        },
    )


def _gravity_load(now: Situation) -> Draw:
    torque = now.sized((6e-3, 12e-3), (20e-3, 35e-3), (55e-3, 0.09))
    arm_m = now.between(0.06, 0.12)
    phase = now.angle_rad()
    return Draw(
        params={"gravity_torque_nm": torque, "phase_deg": math.degrees(phase)},
        motor={
            "arm_mass_kg": torque / (GRAVITY_M_PER_S2 * arm_m),
            "arm_length_m": arm_m,
            "arm_phase_rad": phase,
        },
    )


def _cogging(now: Situation) -> Draw:
    torque = now.sized((6e-3, 10e-3), (15e-3, 25e-3), (40e-3, 65e-3))
    cycles = now.one_of(2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0)
    return Draw(
        params={"cogging_torque_nm": torque, "cycles_per_turn": cycles},
        motor={
            "cogging_torque_nm": torque,
            "cogging_cycles": cycles,
            "cogging_phase_rad": now.angle_rad(),
        },
    )


def _payload_inertia(now: Situation) -> Draw:
    """A payload from the second recording on, or from some time within one of the first two on."""
    inertia = now.sized((3e-4, 4.5e-4), (7e-4, 1.2e-3), (2e-3, 3.6e-3))
    within = now.recordings == 1 or now.rng.random() < 0.5
    first = int(now.rng.integers(min(2, now.recordings))) if within else 1
    onset_s = float(now.rng.uniform(0.3, 0.6) * now.duration_s) if within else 0.0
    starts = [NEVER_S] * first + [onset_s] + [0.0] * (now.recordings - first - 1)
    return Draw(
        params={"added_inertia_kg_m2": inertia, "from_recording": first + 1.0, "from_s": onset_s},
        motor={"added_inertia_kg_m2": inertia},
        by_recording=tuple({"added_from_s": start} for start in starts),
    )


def _end_stop(now: Situation) -> Draw:
    """A stop within what two recordings reach (or the only one), on the wider side."""
    share = now.sized((0.8, 0.92), (0.5, 0.7), (0.25, 0.4))
    rank = -min(2, now.recordings)
    up = sorted(high for _, high in now.reach_deg)[rank] - max(now.starts_deg)
    down = min(now.starts_deg) + sorted(-low for low, _ in now.reach_deg)[rank]
    side = 1.0 if up >= down else -1.0
    limit_deg = max(now.starts_deg) + share * up if side > 0.0 else min(now.starts_deg) - share * down
    return Draw(
        params={"limit_deg": limit_deg}, motor={"stop_side": side, "stop_rad": math.radians(limit_deg)}
    )


def _constant_load(now: Situation) -> Draw:
    torque = now.sign() * now.sized((3e-3, 6e-3), (10e-3, 18e-3), (30e-3, 50e-3))
    return Draw(params={"load_torque_nm": torque}, motor={"constant_torque_nm": torque})


def _spring_load(now: Situation) -> Draw:
    stiffness = now.sized((4e-4, 8e-4), (1.5e-3, 3e-3), (6e-3, 12e-3))
    rest_deg = float(now.rng.uniform(-180.0, 180.0))
    return Draw(
        params={"stiffness_nm_per_rad": stiffness, "rest_angle_deg": rest_deg},
        motor={"band_stiffness_nm_per_rad": stiffness, "band_rest_rad": math.radians(rest_deg)},
    )


LOAD: tuple[ConcealedEffect, ...] = (
    ConcealedEffect("backlash", "kinematic", _backlash, clashes=("shaft_compliance",)),
    ConcealedEffect("shaft_compliance", "kinematic", _shaft_compliance, clashes=("backlash",)),
    ConcealedEffect("gravity_load", "torque_balance", _gravity_load),
    ConcealedEffect("cogging", "torque_balance", _cogging),
    ConcealedEffect("payload_inertia", "torque_balance", _payload_inertia),
    ConcealedEffect("constant_load", "torque_balance", _constant_load),
    ConcealedEffect("spring_load", "torque_balance", _spring_load),
    ConcealedEffect("end_stop", "torque_balance", _end_stop, needs_reach=True),
)
