"""What another model gains over the one that is in use, by free runs over what was seen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.physics.plant import Plant
from nxt_twin.physics.recorded import signals_of
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Simulator, free_job, with_supply
from nxt_twin.physics.start import restarts
from nxt_twin.recording.columns import Port
from nxt_twin.recording.recording import Recording

_RUN_S = 2.0
_WORTHWHILE = 0.95
_LARGE = 0.8
_ABOUT = 1.1
_SMALL_DEG = 1.0
"""An error below two steps of a tolerance, half a count of the encoder each, bothers nobody."""


@final
@dataclass(frozen=True)
class Gain:
    """The error of free runs of two seconds each.

    Attributes:
        before_deg: root mean square with the model in use.
        after_deg: with the other.
    """

    before_deg: float
    after_deg: float

    @property
    def worthwhile(self) -> bool:
        """Whether the other is nearer by more than what reading it differently would bring."""
        return self.after_deg < _WORTHWHILE * self.before_deg

    @property
    def kept(self) -> bool:
        """Whether the other is nearer, or about as near where the error is small either way."""
        small = self.before_deg < _SMALL_DEG and self.after_deg < _ABOUT * self.before_deg
        return small or self.after_deg < self.before_deg

    @property
    def large(self) -> bool:
        """Whether the other is so clearly nearer that nobody has to ask for it."""
        return self.after_deg < _LARGE * self.before_deg and self.before_deg > _SMALL_DEG


def gain(before: Plant, after: Plant, recording: Recording, port: Port) -> Gain:
    """What `after` gains over `before` on a motor's recording.

    Raises:
        RecordingError: the motor was not driven or not read.
    """
    signals = signals_of(recording, port)
    return Gain(_off_deg(before, signals), _off_deg(after, signals))


def _off_deg(plant: Plant, signals: Signals) -> float:
    supplied = with_supply(signals, plant)
    start = restarts(supplied, _RUN_S)
    with Simulator(plant.layout, workers=1) as simulator:
        predicted = simulator.trace(plant, free_job(supplied, start))["predicted"]
    counted = np.isfinite(signals.measured) & ~start.at
    return float(np.degrees(np.sqrt(np.mean((signals.measured - predicted)[counted] ** 2))))
