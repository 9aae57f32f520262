"""The host's record of a true run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray
from nxt_twin.blind.truth.motor import Motor
from nxt_twin.blind.truth.run import Commands, true_run
from nxt_twin.blind.truth.sensing import Sensing, hold_stale, read_battery
from nxt_twin.recording.recording import Recording

BATTERY_EVERY_ROWS: Final = 20


@final
@dataclass(frozen=True)
class Taken:
    """A recording and the truth behind it; arrays have shape (rows,).

    Attributes:
        recording: what the solver gets.
        hub_deg: the hub's true angle when each reading was taken.
        read_deg: the encoder's reading, before it was cut to whole degrees.
    """

    recording: Recording
    hub_deg: FloatArray
    read_deg: FloatArray


def take(rng: Generator, name: str, motor: Motor, sensing: Sensing, commands: Commands) -> Taken:
    """Run the motor and record it.

    The host reads the battery in about one row of twenty, and always in the first. It gets the terminal
    voltage as the brick last refreshed it (every 167 ms). Without internal resistance this is the
    open-circuit voltage.
    """
    run = true_run(motor, sensing, commands)
    rows = run.stamp_s.size
    stale = rng.random(rows) < sensing.stale_fraction
    read_deg = hold_stale(run.encoder_deg, stale)
    battery_v = read_battery(run.terminal_v, rng.standard_normal(rows))
    sampled = rng.random(rows) < (0.0 if sensing.battery_once else 1.0 / BATTERY_EVERY_ROWS)
    sampled[0] = True
    columns = {
        "time_s": run.stamp_s,
        "a_power_pct": commands.power_pct,
        "a_tacho_deg": np.floor(read_deg),
        "battery_v": np.where(sampled, np.round(battery_v, 3), np.nan),
    }
    if np.any(commands.mode):
        columns["a_mode"] = commands.mode.astype(np.float64)
    return Taken(Recording(name=name, columns=columns), run.hub_deg, read_deg)
