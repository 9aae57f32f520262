"""Concealed battery, bridge and winding."""

from __future__ import annotations

import math

from nxt_twin.blind.effects.concealed import ConcealedEffect, Draw, Situation

QUICK_WINDING_S = 1e-4
DRAIN_FOR_S = 15.0


def _inductance(now: Situation) -> Draw:
    lag_s = now.sized((4e-3, 7e-3), (12e-3, 20e-3), (30e-3, 50e-3))
    inductance_h = lag_s * now.motor.resistance_ohm
    return Draw(
        params={"inductance_h": inductance_h},
        motor={"inductance_h": inductance_h},
        absent={"inductance_h": QUICK_WINDING_S * now.motor.resistance_ohm},
    )


def _battery_sag(now: Situation) -> Draw:
    resistance = now.sized((0.4, 0.7), (1.0, 1.7), (2.2, 3.5))
    return Draw(params={"internal_resistance_ohm": resistance}, motor={"internal_resistance_ohm": resistance})


def _battery_drain(now: Situation) -> Draw:
    per_run_v = now.sized((0.2, 0.35), (0.7, 1.1), (1.6, 2.6))
    drain = per_run_v / max(now.duration_s, DRAIN_FOR_S)
    return Draw(
        params={"drain_v_per_s": drain}, motor={"drain_v_per_s": drain}, sensing={"battery_once": 1.0}
    )


def _winding_heating(now: Situation) -> Draw:
    rise = now.sized((2e-3, 4e-3), (1e-2, 2e-2), (4e-2, 8e-2))
    time_s = now.between(20.0, 100.0)
    return Draw(
        params={"resistance_rise_per_joule": rise, "thermal_time_constant_s": time_s},
        motor={"resistance_rise_per_joule": rise, "thermal_time_s": time_s},
    )


def _current_limit(now: Situation) -> Draw:
    limit = now.sized((0.9, 1.2), (0.5, 0.7), (0.2, 0.35))
    return Draw(params={"current_limit_a": limit}, motor={"current_limit_a": limit})


def _voltage_drop(now: Situation) -> Draw:
    drop = now.sized((0.2, 0.35), (0.5, 0.8), (1.1, 1.6))
    return Draw(params={"drop_v": drop}, motor={"drop_v": drop})


def _power_curve(now: Situation) -> Draw:
    exponent = math.exp(now.sign() * now.sized((0.05, 0.09), (0.15, 0.25), (0.35, 0.55)))
    return Draw(params={"exponent": exponent}, motor={"power_exponent": exponent})


ELECTRICAL: tuple[ConcealedEffect, ...] = (
    ConcealedEffect("inductance", "electrical", _inductance, leaves_out="inductance_h"),
    ConcealedEffect("battery_sag", "electrical", _battery_sag),
    ConcealedEffect("battery_drain", "electrical", _battery_drain),
    ConcealedEffect("winding_heating", "electrical", _winding_heating),
    ConcealedEffect("current_limit", "electrical", _current_limit),
    ConcealedEffect("voltage_drop", "electrical", _voltage_drop),
    ConcealedEffect("power_curve", "electrical", _power_curve),
)
