"""Play a recording to the live twin."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.api.files import ModelSource, load_plant
from nxt_twin.arrays import FloatArray
from nxt_twin.brick.clock import PacedClock, SystemClock
from nxt_twin.brick.links.recorded import RecordedBrick
from nxt_twin.errors import RecordingError
from nxt_twin.recording.recording import Recording
from nxt_twin.twin.records import Event, Innovation
from nxt_twin.twin.replayed import replay_sitting
from nxt_twin.twin.sinks import Memory

_ALL: Final = 10_000_000


@final
@dataclass(frozen=True, repr=False)
class Replayed:
    """The twin's prediction of each reading of a channel, beside the reading.

    Attributes:
        channel: the column, such as `a_tacho_deg`.
        time_s: when the readings arrived, s since the first row, shape (readings,).
        measured: the readings, in the column's unit.
        predicted: the Kalman filter's one-step prediction of each reading, in the column's unit.
        std: the predicted standard deviation of the innovation, in the column's unit.
        events: the monitor's events in order: divergences, stalls, and their end.
    """

    channel: str
    time_s: FloatArray
    measured: FloatArray
    predicted: FloatArray
    std: FloatArray
    events: tuple[Event, ...]

    def __repr__(self) -> str:
        """Short: channel, size and what was said."""
        said = ", ".join(dict.fromkeys(event.kind for event in self.events))
        return f"<Replayed {self.channel}: {self.time_s.size} readings; {said}>"


def replay(plant: ModelSource, recording: Recording) -> dict[str, Replayed]:
    """Play a brick's recording to the live twin: the filters and the monitor of `nxt-twin live`, in virtual time.

    Args:
        plant: the model of every motor: a plant, a name, a path or a mapping, as for `load_plant`.
        recording: of a brick, with commands and counts.

    Returns:
        By channel, the readings beside the Kalman filter's one-step predictions.

    Raises:
        PlantError: the model is no motor.
        RecordingError: the recording holds no motor.

    >>> import nxt_twin as nt
    >>> run = nt.record("mock:", "run.csv", program="gentle_steps", seconds=3.0)
    >>> nt.replay("nxt_motor", run)
    {'a_tacho_deg': <Replayed a_tacho_deg: 301 readings; started, stopped>}
    """
    model, clock = load_plant(plant), PacedClock(SystemClock(), math.inf)
    memory, ports = Memory(_ALL), RecordedBrick(recording, clock).ports
    if not ports:
        mend = "record a_power_pct and a_tacho_deg"
        raise RecordingError("holds no motor", where=recording.name, mend=mend)
    sitting, lasts_s = replay_sitting(recording, dict.fromkeys(ports, model), clock, memory)
    sitting.session.run(lasts_s)
    innovations = [innovation for tick in memory.ticks for innovation in tick.innovations]
    channels = dict.fromkeys(innovation.channel for innovation in innovations)
    return {channel: _replayed(channel, innovations, memory.events) for channel in channels}


def _replayed(channel: str, innovations: list[Innovation], events: list[Event]) -> Replayed:
    of_it = [innovation for innovation in innovations if innovation.channel == channel]
    table = np.array([(each.time_s, each.measured, each.predicted, each.variance) for each in of_it])
    said = tuple(event for event in events if event.channel in (channel, None))
    return Replayed(channel, table[:, 0], table[:, 1], table[:, 2], np.sqrt(table[:, 3]), said)
