"""Parameters of a foreign family's motor, named as in docs/formats.md; each family has its own equations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray

NEVER_S: Final = 1e9
STAMPS_APART_S: Final = 1e-4


@final
@dataclass(frozen=True)
class Numbers:
    """One motor with its battery and load; angles are those of the output hub, an effect of zero is absent.

    `stranger` is the number, from one, of a physics in nobody's library, `a` to `d` are its numbers; `share` is
    the part of the friction that a second inertia bears. `seed` draws what a family's own base varies by.
    """

    resistance_ohm: float
    inductance_h: float
    torque_constant_nm_per_a: float
    viscous_friction_nm_s_per_rad: float
    inertia_kg_m2: float
    supply_v: float
    coulomb_forward_nm: float
    coulomb_reverse_nm: float
    seed: float = 0.0

    presliding_rad: float = 0.0
    stiction_excess_nm: float = 0.0
    stribeck_speed_rad_s: float = 1.0
    friction_per_torque: float = 0.0
    quadratic_drag_nm_s2_per_rad2: float = 0.0
    cold_extra_torque_nm: float = 0.0
    warmup_time_s: float = 1.0
    binding_torque_nm: float = 0.0
    binding_cycles: float = 1.0
    binding_phase_rad: float = 0.0

    load_inertia_kg_m2: float = 0.0
    gap_rad: float = 0.0
    shaft_stiffness_nm_per_rad: float = 0.0
    shaft_damping_nm_s_per_rad: float = 0.0
    share: float = 0.0
    gravity_torque_nm: float = 0.0
    gravity_phase_rad: float = 0.0
    gravity_from_s: float = 0.0
    cogging_torque_nm: float = 0.0
    cogging_cycles: float = 1.0
    cogging_phase_rad: float = 0.0
    added_inertia_kg_m2: float = 0.0
    added_from_s: float = NEVER_S
    stop_side: float = 0.0
    stop_rad: float = 0.0
    load_torque_nm: float = 0.0
    spring_nm_per_rad: float = 0.0
    spring_rest_rad: float = 0.0

    internal_resistance_ohm: float = 0.0
    drain_v_per_s: float = 0.0
    resistance_rise_per_joule: float = 0.0
    thermal_time_s: float = 60.0
    current_limit_a: float = 0.0
    drop_v: float = 0.0
    power_exponent: float = 1.0
    lost_fraction: float = 0.0
    lost_above_rad_s: float = 0.0

    stranger: float = 0.0
    a: float = 0.0
    b: float = 0.0
    c: float = 0.0
    d: float = 0.0

    @property
    def stall_nm(self) -> float:
        """The torque at rest under full voltage, N·m."""
        return self.torque_constant_nm_per_a * self.supply_v / self.resistance_ohm

    @property
    def coulomb_nm(self) -> float:
        """Coulomb friction, the mean of both directions, N·m."""
        return 0.5 * (self.coulomb_forward_nm + self.coulomb_reverse_nm)


@final
@dataclass(frozen=True)
class Chain:
    """Between the motor and the rows of a recording: when commands act, what is stamped, what is read.

    A reading's stamp is `(1 + rate_error) · (t + lag)`, the lag wandering between 0 and `lag_span_s`. With
    `lag_by_chance` each row is late by itself, and none overtakes the row before it; `lag_share` is how many rows are
    late at all. A command acts `delay_s` after its poll; with `late_rows` it is written into the row after.
    """

    delay_s: float = 0.0
    late_rows: float = 0.0
    rate_error: float = 0.0
    lag_span_s: float = 0.0
    lag_period_s: float = 1.0
    lag_phase: float = 0.0
    lag_by_chance: float = 0.0
    lag_share: float = 1.0
    stale_fraction: float = 0.0
    refresh_period_s: float = 0.0
    eccentricity_deg: float = 0.0
    eccentricity_cycles: float = 1.0
    eccentricity_phase_rad: float = 0.0
    battery_once: float = 0.0

    def lag_s(self, true_s: FloatArray) -> FloatArray:
        """By how much the stamps of readings taken at these times are late, s."""
        if self.lag_span_s == 0.0:
            return np.zeros(true_s.size)
        if self.lag_by_chance:
            return self._lag_by_chance_s(true_s)
        turn = true_s / self.lag_period_s + self.lag_phase
        second = 0.3 * np.cos(2.0 * np.pi * 2.3 * turn)
        wave = 0.5 + 0.5 * (np.sin(2.0 * np.pi * turn) + second) / 1.3
        return np.asarray(self.lag_span_s * wave, dtype=np.float64)

    def _lag_by_chance_s(self, true_s: FloatArray) -> FloatArray:
        """Mostly short, seldom long; `lag_phase` draws it, so that rows and commands agree."""
        rng = np.random.default_rng([int(self.lag_phase * 2.0**32), int(1e6 * (true_s[-1] - true_s[0]))])
        late_s = self.lag_span_s * rng.random(true_s.size) ** 2
        if self.lag_share < 1.0:
            late_s = np.where(rng.random(true_s.size) < self.lag_share, late_s, 0.0)
        stamped_s = true_s + late_s
        apart_s = STAMPS_APART_S * np.arange(true_s.size)
        in_order_s = np.maximum.accumulate(stamped_s - apart_s) + apart_s
        return np.asarray(in_order_s - true_s, dtype=np.float64)

    def encoder_deg(self, hub_deg: FloatArray, miscount_deg: FloatArray) -> FloatArray:
        """The encoder's reading before it is cut to its steps."""
        turn_rad = self.eccentricity_cycles * np.deg2rad(hub_deg) + self.eccentricity_phase_rad
        return np.asarray(hub_deg + miscount_deg + self.eccentricity_deg * np.sin(turn_rad))
