"""Starts of free runs from the state that a plant's own observer has reached."""

from __future__ import annotations

from nxt_twin.physics.observer import Noise, observer
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Job, Simulator
from nxt_twin.physics.start import Start, windows


def observed_starts(
    simulator: Simulator, plant: Plant, signals: Signals, first: Start, noise: Noise, every_s: float
) -> Start:
    """Start anew every `every_s` seconds from what the plant, corrected at each reading until then, knows.

    `first` gives the state at the first reading. Where it may be wrong, the first window begins after a run-in.

    At 30 polls a second a smoother that does not know the commands is off by degrees within a time constant.
    """
    corrected = Job(signals, observer(signals, noise), first, noise.disturbance_time_s)
    return simulator.reached(plant, corrected, windows(signals, every_s))
