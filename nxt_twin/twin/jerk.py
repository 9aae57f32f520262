"""The change of a motion by a command whose time of action is uncertain."""

from __future__ import annotations

import math
from typing import NamedTuple, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.base.dc_motor import drive
from nxt_twin.physics.late import effects_delay_s
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.twin.batch import STEP_S
from nxt_twin.twin.bridge import COAST, Hold

_OPEN_FADES_S = 0.5
"""About how long a motor without current keeps a difference of speed: only friction slows it."""


@final
class Jerk(NamedTuple):
    """A change of the motor's drive, dated badly.

    Attributes:
        at_s: when it should have happened.
        speed_std: of the speed just after it, rad/s, because it came sooner or later.
        fades_s: how long that takes to fade.
    """

    at_s: float
    speed_std: float
    fades_s: float

    def spread(self, since_s: float) -> FloatArray:
        """Covariance of angle and speed, rad and rad/s, so long after it; shape (2, 2)."""
        left = math.exp(-since_s / self.fades_s)
        reach = self.speed_std * np.array([self.fades_s * (1.0 - left), left])
        return np.outer(reach, reach)


@final
class Jerks:
    """Those that are still to be felt by filters which take readings at the same moments."""

    def __init__(self) -> None:
        self._coming: list[Jerk] = []

    def expect(self, jerk: Jerk) -> None:
        """One more."""
        self._coming.append(jerk)

    def felt(self, now_s: float) -> FloatArray | None:
        """Covariance of angle and speed by those that came since it was asked last, shape (2, 2); None for none."""
        came = [jerk for jerk in self._coming if jerk.at_s <= now_s]
        if not came:
            return None
        self._coming = [jerk for jerk in self._coming if jerk.at_s > now_s]
        felt: FloatArray = np.sum([jerk.spread(now_s - jerk.at_s) for jerk in came], axis=0)
        return felt


@final
class Drive:
    """How hard commands drive a plant.

    Args:
        plant: a dc motor.
    """

    def __init__(self, plant: Plant) -> None:
        self._resistance, self._torque_constant, self._back_emf, self._inertia = (
            plant.values[Slot(BASE_OWNER, symbol)]
            for symbol in ("resistance", "torque_constant", "back_emf", "inertia")
        )
        self._fades_s = self._inertia * self._resistance / (self._torque_constant * self._back_emf)
        self._delay_s = effects_delay_s(plant)

    def jerk(
        self, at_s: float, std_s: float, before: Hold, after: Hold, speed: float, supply_v: float
    ) -> Jerk:
        """What comes of a command that acts at a moment known to `std_s`, while the motor turns at `speed`."""
        change = self._torque(after, speed, supply_v) - self._torque(before, speed, supply_v)
        fades_s = _OPEN_FADES_S if after.mode == COAST else self._fades_s
        return Jerk(at_s + self._delay_s, std_s * abs(change) / self._inertia, fades_s)

    def _torque(self, hold: Hold, speed: float, supply_v: float) -> float:
        """The torque of a quick winding, N·m."""
        pull, damping = drive(
            hold.duty,
            hold.mode,
            supply_v,
            self._resistance,
            0.0,
            self._torque_constant,
            self._back_emf,
            drop=0.0,
            knee=0.0,
            limit=math.inf,
            speed=speed,
            current=0.0,
            step_s=STEP_S,
        )
        return pull - damping * speed
