"""The contract's motor effects, drawn in its own parameters, in sizes that suit the motor."""

from __future__ import annotations

import math
from typing import Final

from nxt_twin.blind.families.numbers import NEVER_S
from nxt_twin.blind.families.setting import DrawnCase, HiddenEffect, Hideable


def _coulomb(at: DrawnCase) -> HiddenEffect:
    level = at.torque(small=(3e-3, 6e-3), medium=(9e-3, 15e-3), large=(22e-3, 40e-3))
    both = {"coulomb_forward_nm": level, "coulomb_reverse_nm": level}
    return HiddenEffect({"coulomb_friction_nm": level}, both, absent=dict.fromkeys(both, 0.0))


def _viscous(at: DrawnCase) -> HiddenEffect:
    slope = at.torque(small=(0.7e-3, 1.2e-3), medium=(2e-3, 3.2e-3), large=(5e-3, 9e-3))
    key = "viscous_friction_nm_s_per_rad"
    return HiddenEffect({key: slope}, {key: slope}, absent={key: 0.0})


def _presliding(at: DrawnCase) -> HiddenEffect:
    reach_deg = at.among(small=(1.5, 2.5), medium=(4.0, 7.0), large=(9.0, 15.0))
    return HiddenEffect({"presliding_deg": reach_deg}, {"presliding_rad": math.radians(reach_deg)})


def _stiction(at: DrawnCase) -> HiddenEffect:
    excess = at.torque(small=(4e-3, 7e-3), medium=(10e-3, 18e-3), large=(25e-3, 45e-3))
    speed = at.between(0.5, 3.0)
    return HiddenEffect(
        {"breakaway_torque_nm": at.motor.coulomb_nm + excess, "stribeck_speed_rad_s": speed},
        {"stiction_excess_nm": excess, "stribeck_speed_rad_s": speed},
    )


def _asymmetric(at: DrawnCase) -> HiddenEffect:
    half = at.torque(small=(2e-3, 3e-3), medium=(5e-3, 8e-3), large=(11e-3, 20e-3)) * at.side()
    mean = max(at.motor.coulomb_nm, 1.3 * abs(half))
    truth = {"coulomb_forward_nm": mean + half, "coulomb_reverse_nm": mean - half}
    return HiddenEffect(truth, truth, absent=dict.fromkeys(truth, mean))


def _load_dependent(at: DrawnCase) -> HiddenEffect:
    share = at.among(small=(0.06, 0.09), medium=(0.14, 0.22), large=(0.3, 0.45))
    return HiddenEffect({"friction_per_torque": share}, {"friction_per_torque": share})


def _drag(at: DrawnCase) -> HiddenEffect:
    key = "quadratic_drag_nm_s2_per_rad2"
    drag = at.torque(small=(5e-5, 9e-5), medium=(1.6e-4, 3e-4), large=(5e-4, 1e-3))
    return HiddenEffect({key: drag}, {key: drag})


def _warmup(at: DrawnCase) -> HiddenEffect:
    extra = at.torque(small=(6e-3, 9e-3), medium=(13e-3, 22e-3), large=(30e-3, 50e-3))
    time_s = at.between(0.15, 0.5) * at.duration_s
    return HiddenEffect(
        {"cold_extra_torque_nm": extra, "time_constant_s": time_s},
        {"cold_extra_torque_nm": extra, "warmup_time_s": time_s},
    )


def _binding(at: DrawnCase) -> HiddenEffect:
    torque = at.torque(small=(9e-3, 15e-3), medium=(22e-3, 38e-3), large=(60e-3, 0.1))
    cycles = at.pick(1.0, 1.0, 2.0, 3.0)
    numbers = {"binding_torque_nm": torque, "binding_cycles": cycles, "binding_phase_rad": at.phase()}
    return HiddenEffect({"binding_torque_nm": torque, "cycles_per_turn": cycles}, numbers)


def _backlash(at: DrawnCase) -> HiddenEffect:
    gap_deg = at.among(small=(1.5, 3.0), medium=(4.0, 7.0), large=(9.0, 16.0))
    inertia = at.inertia(small=(0.3, 0.5), medium=(0.6, 1.0), large=(1.1, 1.9))
    numbers = {
        "gap_rad": math.radians(gap_deg),
        "load_inertia_kg_m2": inertia,
        "share": at.pick(0.0, 0.2, 0.5),
    }
    return HiddenEffect({"gap_deg": gap_deg, "load_inertia_kg_m2": inertia}, numbers)


def _compliance(at: DrawnCase) -> HiddenEffect:
    inertia = at.inertia(small=(0.25, 0.45), medium=(0.5, 0.9), large=(1.0, 1.7))
    pulsation = 2.0 * math.pi * at.among(small=(9.0, 14.0), medium=(5.0, 8.0), large=(2.2, 4.0))
    stiffness = inertia * pulsation**2
    numbers = {
        "load_inertia_kg_m2": inertia,
        "shaft_stiffness_nm_per_rad": stiffness,
        "shaft_damping_nm_s_per_rad": 2.0 * at.between(0.03, 0.12) * inertia * pulsation,
        "share": at.pick(0.0, 0.2, 0.5),
    }
    return HiddenEffect({"stiffness_nm_per_rad": stiffness, "load_inertia_kg_m2": inertia}, numbers)


def _gravity(at: DrawnCase) -> HiddenEffect:
    torque = at.torque(small=(7e-3, 13e-3), medium=(20e-3, 35e-3), large=(55e-3, 0.09))
    phase = at.phase()
    return HiddenEffect(
        {"gravity_torque_nm": torque, "phase_deg": math.degrees(phase)},
        {"gravity_torque_nm": torque, "gravity_phase_rad": phase},
    )


def _hanging(at: DrawnCase) -> HiddenEffect:
    """An arm with a payload, put on between two recordings."""
    torque = at.torque(small=(10e-3, 15e-3), medium=(22e-3, 38e-3), large=(55e-3, 0.09))
    inertia = at.inertia(small=(0.3, 0.45), medium=(0.7, 1.1), large=(1.6, 3.0))
    phase, first = at.phase(), _second_or_later(at)
    starts = [NEVER_S] * first + [0.0] * (at.recordings - first)
    return HiddenEffect(
        {
            "gravity_torque_nm": torque,
            "added_inertia_kg_m2": inertia,
            "phase_deg": math.degrees(phase),
            "from_recording": first + 1.0,
        },
        {"gravity_torque_nm": torque, "added_inertia_kg_m2": inertia, "gravity_phase_rad": phase},
        by_recording=tuple({"added_from_s": start, "gravity_from_s": start} for start in starts),
    )


def _cogging(at: DrawnCase) -> HiddenEffect:
    torque = at.torque(small=(7e-3, 11e-3), medium=(15e-3, 26e-3), large=(40e-3, 65e-3))
    cycles = at.pick(2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 12.0, 16.0)
    numbers = {"cogging_torque_nm": torque, "cogging_cycles": cycles, "cogging_phase_rad": at.phase()}
    return HiddenEffect({"cogging_torque_nm": torque, "cycles_per_turn": cycles}, numbers)


def _second_or_later(at: DrawnCase) -> int:
    """The number, from zero, of a recording that is not the first, nor the last where that may be held out."""
    return int(at.rng.integers(1, max(2, at.recordings - 1)))


def _payload(at: DrawnCase) -> HiddenEffect:
    """From one recording on, or from some time within one."""
    inertia = at.inertia(small=(0.3, 0.45), medium=(0.7, 1.1), large=(1.6, 3.0))
    within = at.recordings == 1 or at.rng.random() < 0.4
    first = int(at.rng.integers(max(1, at.recordings - 1))) if within else _second_or_later(at)
    from_s = float(at.rng.uniform(0.3, 0.65)) * at.duration_s if within else 0.0
    starts = [NEVER_S] * first + [from_s] + [0.0] * (at.recordings - first - 1)
    return HiddenEffect(
        {"added_inertia_kg_m2": inertia, "from_recording": first + 1.0, "from_s": from_s},
        {"added_inertia_kg_m2": inertia},
        by_recording=tuple({"added_from_s": start} for start in starts),
    )


def _stop(at: DrawnCase) -> HiddenEffect:
    """On the side on which the second widest recording (or the only one) reaches furthest."""
    share = at.among(small=(0.8, 0.92), medium=(0.5, 0.7), large=(0.25, 0.4))
    rooms = {}
    for side, column in ((1.0, 1), (-1.0, 0)):
        origin = max(side * start for start in at.starts_deg)
        widest = sorted((side * reach[column] - origin for reach in at.reach_deg), reverse=True)
        rooms[side] = (widest[min(1, len(widest) - 1)], origin)
    side = max(rooms, key=lambda each: rooms[each][0])
    room, origin = rooms[side]
    limit_deg = side * (origin + share * max(room, 5.0))
    return HiddenEffect({"limit_deg": limit_deg}, {"stop_side": side, "stop_rad": math.radians(limit_deg)})


def _constant(at: DrawnCase) -> HiddenEffect:
    torque = at.side() * at.torque(small=(4e-3, 7e-3), medium=(11e-3, 19e-3), large=(30e-3, 50e-3))
    return HiddenEffect({"load_torque_nm": torque}, {"load_torque_nm": torque})


def _spring(at: DrawnCase) -> HiddenEffect:
    stiffness = at.torque(small=(5e-4, 9e-4), medium=(1.6e-3, 3e-3), large=(5e-3, 1e-2))
    rest_deg = float(at.rng.uniform(-150.0, 150.0))
    return HiddenEffect(
        {"stiffness_nm_per_rad": stiffness, "rest_angle_deg": rest_deg},
        {"spring_nm_per_rad": stiffness, "spring_rest_rad": math.radians(rest_deg)},
    )


LOADS: Final = (
    Hideable("coulomb_friction", "torque_balance", _coulomb, leaves_out="coulomb_friction_nm",
             clashes=("asymmetric_friction",)),
    Hideable("viscous_friction", "torque_balance", _viscous, leaves_out="viscous_friction_nm_s_per_rad", coasts=True),
    Hideable("presliding", "torque_balance", _presliding),
    Hideable("asymmetric_friction", "torque_balance", _asymmetric, clashes=("coulomb_friction",)),
    Hideable("stiction", "torque_balance", _stiction),
    Hideable("load_dependent_friction", "torque_balance", _load_dependent),
    Hideable("quadratic_drag", "torque_balance", _drag),
    Hideable("friction_warmup", "torque_balance", _warmup),
    Hideable("angle_dependent_friction", "torque_balance", _binding),
    Hideable("backlash", "kinematic", _backlash, clashes=("shaft_compliance",)),
    Hideable("shaft_compliance", "kinematic", _compliance, clashes=("backlash",)),
    Hideable("gravity_load", "torque_balance", _gravity, clashes=("hanging_payload",)),
    Hideable("cogging", "torque_balance", _cogging),
    Hideable("payload_inertia", "torque_balance", _payload, clashes=("hanging_payload",)),
    Hideable("hanging_payload", "torque_balance", _hanging, clashes=("gravity_load", "payload_inertia"),
             least_recordings=2),
    Hideable("constant_load", "torque_balance", _constant),
    Hideable("spring_load", "torque_balance", _spring),
    Hideable("end_stop", "torque_balance", _stop),
)  # fmt: skip
"""What acts on the hub; the stop last, since it looks at the rest."""
