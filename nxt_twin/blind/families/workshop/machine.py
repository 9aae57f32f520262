"""The machine of this family, and the physics in nobody's library that it knows."""

from __future__ import annotations

from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.blind.families.compiled import as_record
from nxt_twin.blind.families.machine import Machine
from nxt_twin.blind.families.numbers import Numbers
from nxt_twin.blind.families.setting import DrawnCase, HiddenEffect, Hideable
from nxt_twin.blind.families.workshop import steps, torques
from nxt_twin.blind.families.workshop.base import draw_flaws


@final
class Workshop(Machine):
    """A motor at rest at `start_rad`; its load stands in the middle of its play."""

    def __init__(self, motor: Numbers, start_rad: float, begins_s: float = 0.0) -> None:
        self._motor, self._flaws = as_record(motor), as_record(draw_flaws(motor))
        self._state = np.zeros(steps.STATES)
        self._state[[steps.THETA, steps.THETA_L, steps.ANCHOR]] = start_rad
        self._state[steps.MEMORY] = begins_s
        self._now_s = begins_s

    def run(self, stops_s: FloatArray, duty: float, mode: int) -> FloatArray:
        """As `Machine.run`."""
        out = steps.advance(self._motor, self._flaws, self._now_s, stops_s, duty, mode, self._state)
        self._now_s = float(stops_s[-1])
        return out


def _dwell_adhesion(at: DrawnCase) -> HiddenEffect:
    torque = at.torque(small=(0.02, 0.03), medium=(0.05, 0.08), large=(0.1, 0.16))
    return _strange(torques.DWELL_ADHESION, a=torque, b=at.between(0.3, 1.0))


def _brownout(at: DrawnCase) -> HiddenEffect:
    stall_a = at.motor.supply_v / at.motor.resistance_ohm
    trip_a = stall_a * at.among(small=(0.9, 1.0), medium=(0.65, 0.8), large=(0.4, 0.55))
    return _strange(torques.BROWNOUT, a=trip_a, b=at.between(0.06, 0.2))


def _centrifugal_brake(at: DrawnCase) -> HiddenEffect:
    fastest = at.motor.supply_v / at.motor.torque_constant_nm_per_a
    above = fastest * at.between(0.3, 0.5)
    torque = at.torque(small=(0.03, 0.05), medium=(0.08, 0.12), large=(0.2, 0.35))
    return _strange(torques.CENTRIFUGAL_BRAKE, a=torque / (fastest - above) ** 2, b=above)


def _worn_segment(at: DrawnCase) -> HiddenEffect:
    rise = at.among(small=(0.4, 0.6), medium=(1.0, 1.6), large=(3.0, 5.0))
    return _strange(torques.WORN_SEGMENT, a=rise, b=at.pick(1.0, 2.0, 3.0), c=at.pick(0.5, 0.8), d=at.phase())


def _strange(kind: int, **numbers: float) -> HiddenEffect:
    return HiddenEffect(numbers, {"stranger": float(kind), **numbers})


STRANGERS: Final = (
    Hideable("dwell_adhesion", "torque_balance", _dwell_adhesion, known=False),
    Hideable("brownout", "electrical", _brownout, known=False),
    Hideable("centrifugal_brake", "torque_balance", _centrifugal_brake, known=False),
    Hideable("worn_segment", "electrical", _worn_segment, known=False),
)
"""One in a case."""
