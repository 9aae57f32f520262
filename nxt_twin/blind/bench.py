"""The bench on which a case is recorded: a motor off its nominal values, and what the host does with it."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray
from nxt_twin.blind.excitation import FAMILIES
from nxt_twin.blind.polling import LinkName, polls_s
from nxt_twin.blind.truth.motor import Motor
from nxt_twin.blind.truth.run import Commands

SPREAD: Final = 0.2
FULLEST_V: Final = 8.6
EMPTIEST_V: Final = 7.2
MOVING_START_CHANCE: Final = 0.08
PUSH_MEMORY_S: Final = 0.05

ABRUPT: Final = ("steps", "reversals")
SLOW: Final = ("ramps", "coast_downs")


def draw_motor(rng: Generator) -> Motor:
    """A plain motor with each number within ±20 % of the nominal one, and a battery between 7.2 and 8.6 V.

    Torque constant and back-emf constant are one number, as they are in any such motor.
    """
    plain = Motor()
    off = 1.0 + rng.uniform(-SPREAD, SPREAD, 6)
    constant = plain.torque_constant_nm_per_a * float(off[0])
    coulomb = plain.coulomb_forward_nm * float(off[1])
    return replace(
        plain,
        torque_constant_nm_per_a=constant,
        back_emf_v_s_per_rad=constant,
        coulomb_forward_nm=coulomb,
        coulomb_reverse_nm=coulomb,
        resistance_ohm=plain.resistance_ohm * float(off[2]),
        inductance_h=plain.inductance_h * float(off[3]),
        viscous_friction_nm_s_per_rad=plain.viscous_friction_nm_s_per_rad * float(off[4]),
        inertia_kg_m2=plain.inertia_kg_m2 * float(off[5]),
        battery_v=float(rng.uniform(EMPTIEST_V, FULLEST_V)),
        bristle_exponent=float(rng.choice((1.0, 2.0))),
    )


def draw_families(rng: Generator, recordings: int, *, coasting: bool) -> tuple[str, ...]:
    """A different input family for each recording (again from the start after six).

    The first two hold an abrupt and a slow one; with `coasting`, the slow one coasts.
    """
    first = [str(rng.choice(ABRUPT)), "coast_downs" if coasting else str(rng.choice(SLOW))]
    others = [name for name in FAMILIES if name not in first]
    rng.shuffle(first)
    rng.shuffle(others)
    order = first + others
    return tuple(order[index % len(order)] for index in range(recordings))


def draw_starts_deg(rng: Generator, recordings: int) -> tuple[float, ...]:
    """Hub angles at the starts: within the first degree, or in half of the cases anywhere in two turns."""
    fraction = rng.random(recordings)
    if rng.random() < 0.5:
        return tuple(float(start) for start in fraction)
    return tuple(float(start) for start in np.floor(rng.uniform(-360.0, 360.0, recordings)) + fraction)


def draw_commands(
    rng: Generator, family: str, link: LinkName, duration_s: float, start_deg: float, torque_noise_nm: float
) -> Commands:
    """One recording's polls and commands."""
    read_s = polls_s(rng, link, duration_s)
    excitation = FAMILIES[family](rng, read_s)
    moving = rng.random() < MOVING_START_CHANCE
    before_pct = float(np.round(rng.uniform(-60.0, 60.0))) if moving else 0.0
    return Commands(
        read_s=read_s,
        power_pct=excitation.power_pct,
        mode=excitation.mode,
        start_deg=start_deg,
        before_pct=before_pct,
        push_nm=_wandering(rng, read_s, torque_noise_nm),
    )


def _wandering(rng: Generator, time_s: FloatArray, std: float) -> FloatArray:
    """A first-order Markov process of the given standard deviation at irregular times."""
    kept = np.exp(-np.diff(time_s, prepend=time_s[0]) / PUSH_MEMORY_S)
    kicks = std * np.sqrt(1.0 - kept**2) * rng.standard_normal(time_s.size)
    values = np.zeros(time_s.size)
    for row in range(1, time_s.size):
        values[row] = kept[row] * values[row - 1] + kicks[row]
    return values
