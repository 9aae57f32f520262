"""The touch sensor in a world: a plunger against a spring, which snaps at one travel and back at a smaller one."""

from __future__ import annotations

from typing import Final, final

from numpy.random import Generator

from nxt_twin.sensors.touch import TouchParameters
from nxt_twin.world.robot import plunger_name
from nxt_twin.world.senses.surroundings import Surroundings
from nxt_twin.world.sensing import TouchMount

_N_PER_G: Final = 9.81e-3


@final
class TouchSense:
    """Whether a touch sensor is pressed, 0 or 1.

    Its spring takes the model's closing force at the model's closing travel. Each stroke draws where it ends.

    Args:
        mount: where it sits.
        port: of the brick, 1 to 4.
        around: the robot with its plunger.
        rng: chance.
    """

    def __init__(self, mount: TouchMount, port: int, around: Surroundings, rng: Generator) -> None:
        parameters = TouchParameters.from_config(around.model(mount.model))
        press_g, _, _ = parameters.thresholds("force_g")
        self._press_mm, self._release_mm, self._noise_mm = parameters.thresholds("travel_mm")
        stiffness = max(press_g - mount.preload_g, 1.0) * _N_PER_G / (1e-3 * self._press_mm)
        self._around, self._rng, self._link = around, rng, plunger_name(port)
        around.engine.spring(around.robot, self._link, mount.preload_g * _N_PER_G, stiffness)
        self._pressed = False
        self._next_mm = self._drawn()

    def measure(self, time_s: float) -> float:
        """1 if it is pressed."""
        del time_s
        travel_mm = -1e3 * self._around.engine.slide_m(self._around.robot, self._link)
        if travel_mm < self._next_mm if self._pressed else travel_mm >= self._next_mm:
            self._pressed = not self._pressed
            self._next_mm = self._drawn()
        return float(self._pressed)

    def _drawn(self) -> float:
        middle = self._release_mm if self._pressed else self._press_mm
        return float(self._rng.normal(middle, self._noise_mm))
