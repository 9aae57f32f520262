"""The contract's effects of battery, bridge, winding, clock and encoder, drawn in its own parameters."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from nxt_twin.blind.families.setting import DrawnCase, HiddenEffect, Hideable

QUICK_WINDING_S: Final = 1e-4
LEAST_DRAINED_FOR_S: Final = 12.0


def _inductance(at: DrawnCase) -> HiddenEffect:
    lag_s = at.among(small=(4e-3, 7e-3), medium=(12e-3, 20e-3), large=(28e-3, 45e-3))
    inductance_h = lag_s * at.motor.resistance_ohm
    absent = {"inductance_h": QUICK_WINDING_S * at.motor.resistance_ohm}
    return HiddenEffect({"inductance_h": inductance_h}, {"inductance_h": inductance_h}, absent=absent)


def _sag(at: DrawnCase) -> HiddenEffect:
    ohm = at.motor.resistance_ohm * at.among(small=(0.06, 0.09), medium=(0.14, 0.22), large=(0.3, 0.45))
    return HiddenEffect({"internal_resistance_ohm": ohm}, {"internal_resistance_ohm": ohm})


def _drain(at: DrawnCase) -> HiddenEffect:
    fall_v = at.motor.supply_v * at.among(small=(0.03, 0.05), medium=(0.09, 0.14), large=(0.2, 0.3))
    drain = fall_v / max(at.duration_s, LEAST_DRAINED_FOR_S)
    return HiddenEffect({"drain_v_per_s": drain}, {"drain_v_per_s": drain}, {"battery_once": 1.0})


def _heating(at: DrawnCase) -> HiddenEffect:
    rise = at.among(small=(2e-3, 4e-3), medium=(1e-2, 2e-2), large=(4e-2, 8e-2))
    time_s = at.between(15.0, 90.0)
    return HiddenEffect(
        {"resistance_rise_per_joule": rise, "thermal_time_constant_s": time_s},
        {"resistance_rise_per_joule": rise, "thermal_time_s": time_s},
    )


def _limit(at: DrawnCase) -> HiddenEffect:
    stall_a = at.motor.supply_v / at.motor.resistance_ohm
    limit_a = stall_a * at.among(small=(0.8, 1.0), medium=(0.45, 0.65), large=(0.2, 0.33))
    return HiddenEffect({"current_limit_a": limit_a}, {"current_limit_a": limit_a})


def _drop(at: DrawnCase) -> HiddenEffect:
    drop_v = at.motor.supply_v * at.among(small=(0.025, 0.04), medium=(0.06, 0.1), large=(0.13, 0.2))
    return HiddenEffect({"drop_v": drop_v}, {"drop_v": drop_v})


def _curve(at: DrawnCase) -> HiddenEffect:
    bend = at.among(small=(0.05, 0.09), medium=(0.15, 0.25), large=(0.35, 0.55))
    exponent = math.exp(at.side() * bend)
    return HiddenEffect({"exponent": exponent}, {"power_exponent": exponent})


def _delay(at: DrawnCase) -> HiddenEffect:
    """Late in two of three cases; otherwise early, since the logger writes the last command."""
    if at.rng.random() < 1.0 / 3.0:
        early = at.poll_s * at.among(small=(0.3, 0.45), medium=(0.6, 0.75), large=(0.99, 1.0))
        return HiddenEffect({"delay_s": -early}, chain={"delay_s": at.poll_s - early, "late_rows": 1.0})
    delay_s = at.among(small=(5e-3, 10e-3), medium=(15e-3, 30e-3), large=(40e-3, 80e-3))
    return HiddenEffect({"delay_s": delay_s}, chain={"delay_s": delay_s})


def _skew(at: DrawnCase) -> HiddenEffect:
    """The lag wanders in two of three cases; otherwise a busy host stamps each row late by chance."""
    if at.rng.random() < 1.0 / 3.0:
        return _late_by_chance(at)
    span_s = at.among(small=(9e-3, 13e-3), medium=(20e-3, 35e-3), large=(55e-3, 0.09))
    rate = at.side() * at.between(1e-3, 8e-3)
    return HiddenEffect(
        {"lag_span_s": span_s, "rate_error": rate},
        chain={
            "lag_span_s": span_s,
            "rate_error": rate,
            "lag_period_s": at.between(1.5, 6.0),
            "lag_phase": float(at.rng.random()),
        },
    )


def _late_by_chance(at: DrawnCase) -> HiddenEffect:
    """Where few rows are late, they are so by more."""
    span_s = at.poll_s * at.among(small=(0.3, 0.5), medium=(0.6, 0.9), large=(1.2, 2.0))
    rate, phase = at.side() * at.between(1e-3, 8e-3), float(at.rng.random())
    share = _late_share(phase)
    told = {"lag_span_s": span_s / math.sqrt(share), "rate_error": rate}
    return HiddenEffect(told, chain={**told, "lag_phase": phase, "lag_by_chance": 1.0, "lag_share": share})


def _late_share(phase: float) -> float:
    """Every row, or in half of the clocks one in three to twenty; told from what is drawn, so that no clock moves."""
    chance = np.random.default_rng([*b"share", int(phase * 2.0**32)])
    return 1.0 if chance.random() < 0.5 else float(chance.uniform(0.05, 0.33))


def _stale(at: DrawnCase) -> HiddenEffect:
    share = at.among(small=(0.015, 0.025), medium=(0.04, 0.08), large=(0.12, 0.25))
    return HiddenEffect({"stale_fraction": share}, chain={"stale_fraction": share})


def _hold(at: DrawnCase) -> HiddenEffect:
    period_s = at.poll_s * at.among(small=(1.6, 2.4), medium=(3.0, 5.0), large=(6.0, 10.0))
    return HiddenEffect({"refresh_period_s": period_s}, chain={"refresh_period_s": period_s})


def _missed(at: DrawnCase) -> HiddenEffect:
    share = at.among(small=(0.02, 0.035), medium=(0.06, 0.1), large=(0.15, 0.3))
    above = at.between(0.25, 0.5) * at.motor.supply_v / at.motor.torque_constant_nm_per_a
    return HiddenEffect(
        {"loss_fraction": share, "speed_threshold_rad_s": above},
        {"lost_fraction": share, "lost_above_rad_s": above},
    )


def _eccentric(at: DrawnCase) -> HiddenEffect:
    amplitude, cycles = (
        at.among(small=(0.8, 1.2), medium=(2.0, 3.0), large=(5.0, 8.0)),
        at.pick(1.0, 1.0, 2.0),
    )
    return HiddenEffect(
        {"amplitude_deg": amplitude, "cycles_per_turn": cycles},
        chain={
            "eccentricity_deg": amplitude,
            "eccentricity_cycles": cycles,
            "eccentricity_phase_rad": at.phase(),
        },
    )


ELECTRICAL: Final = (
    Hideable("inductance", "electrical", _inductance, leaves_out="inductance_h"),
    Hideable("battery_sag", "electrical", _sag),
    Hideable("battery_drain", "electrical", _drain),
    Hideable("winding_heating", "electrical", _heating),
    Hideable("current_limit", "electrical", _limit),
    Hideable("voltage_drop", "electrical", _drop),
    Hideable("power_curve", "electrical", _curve),
)
"""Battery, bridge and winding."""

MEASURED: Final = (
    Hideable("command_delay", "timing", _delay),
    Hideable("clock_skew", "timing", _skew, clashes=("sample_hold", "stale_samples")),
    Hideable("stale_samples", "timing", _stale, clashes=("clock_skew", "sample_hold")),
    Hideable("sample_hold", "timing", _hold, clashes=("clock_skew", "stale_samples")),
    Hideable("missed_counts", "measurement", _missed),
    Hideable("encoder_eccentricity", "measurement", _eccentric),
)
"""Clock and encoder."""
