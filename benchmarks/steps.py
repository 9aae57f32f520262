"""The problem of the kernel's benchmarks: a minute of an NXT motor under steps of random level."""

from __future__ import annotations

import numpy as np

from nxt_twin.physics.plant import Plant, plant_from_config
from nxt_twin.physics.signals import Signals
from nxt_twin.recording.configs import load_plant_config

DURATION_S = 60.0
HOLD_S = 0.4
READING_S = 0.01
SUPPLY_V = 8.0
LOWEST_DUTY = 0.2  # well above breakaway: the motor passes through zero speed and never sticks there


def motor() -> Plant:
    """The plain motor of the source paper: winding with inductance, Coulomb and viscous friction."""
    return plant_from_config(load_plant_config("nxt_motor"), "power_pct")


def steps(seed: int = 1) -> Signals:
    """A new level every 0.4 s, either way, and a reading due every 10 ms; only the first one is given."""
    rng = np.random.default_rng(seed)
    command_time_s = np.arange(0.0, DURATION_S, HOLD_S)
    level = rng.uniform(LOWEST_DUTY, 1.0, command_time_s.size)
    time_s = np.linspace(0.0, DURATION_S, round(DURATION_S / READING_S) + 1)
    return Signals(
        name="steps",
        channel="a_tacho_deg",
        input_kind="power_pct",
        command_time_s=command_time_s,
        command=level * rng.choice((-1.0, 1.0), command_time_s.size),
        command_mode=np.zeros(command_time_s.size, dtype=np.int64),
        command_supply_v=np.full(command_time_s.size, SUPPLY_V),
        time_s=time_s,
        measured=np.where(time_s == 0.0, 0.0, np.nan),
        is_speed=False,
        quantum=0.0,
    )
