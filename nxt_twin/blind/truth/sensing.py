"""Between the true motor and its recording: command timing, stamps, encoder, battery reading."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray

BATTERY_STEP_V = 0.013848
BATTERY_NOISE_V = 0.004


@final
@dataclass(frozen=True)
class Sensing:
    """The numbers of the measuring chain; zero means that the chain is perfect there.

    A stamp is `(1 + rate_error) · t + lag(t)`; the lag wanders between 0 and `lag_span_s`, as a sine, or as a
    triangle when `lag_triangle` is 1. Commands are issued at their row's stamp and act `delay_s` later.
    """

    delay_s: float = 0.0
    rate_error: float = 0.0
    lag_span_s: float = 0.0
    lag_period_s: float = 1.0
    lag_phase: float = 0.0
    lag_triangle: float = 0.0
    stale_fraction: float = 0.0
    eccentricity_deg: float = 0.0
    eccentricity_cycles: float = 1.0
    eccentricity_phase_rad: float = 0.0
    battery_once: float = 0.0  # 1: the battery is read in the first row only

    def lag_s(self, true_time_s: FloatArray) -> FloatArray:
        """By how much the stamp of a reading taken at `true_time_s` is late, s."""
        turn = true_time_s / self.lag_period_s + self.lag_phase
        triangle = np.abs(2.0 * (turn % 1.0) - 1.0)
        wave = triangle if self.lag_triangle else 0.5 * (1.0 + np.sin(2.0 * np.pi * turn))
        return np.asarray(self.lag_span_s * wave, dtype=np.float64)

    def encoder_deg(self, hub_deg: FloatArray, miscount_deg: FloatArray) -> FloatArray:
        """The encoder's reading before it is cut to whole degrees."""
        turn_rad = self.eccentricity_cycles * np.deg2rad(hub_deg) + self.eccentricity_phase_rad
        return np.asarray(hub_deg + miscount_deg + self.eccentricity_deg * np.sin(turn_rad))


def hold_stale(counts: FloatArray, stale: BoolArray) -> FloatArray:
    """Repeat the reading before in every row marked as stale."""
    rows = np.arange(counts.size)
    return counts[np.maximum.accumulate(np.where(stale, 0, rows))]


def read_battery(terminal_v: FloatArray, noise: FloatArray) -> FloatArray:
    """The brick's battery reading: a little noise (`noise` is standard normal) and steps of 13.848 mV."""
    return np.asarray(np.floor((terminal_v + BATTERY_NOISE_V * noise) / BATTERY_STEP_V) * BATTERY_STEP_V)
