"""A sensor experiment as a list of places, in the order in which they are visited."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, final

from nxt_twin.experiment.plan import (
    AngleSweep,
    DistanceSweep,
    GradientSweep,
    SensorExperiment,
    TouchCycles,
    TwoSensors,
    Waits,
)
from nxt_twin.experiment.positioner.positioner import PositionerAxis
from nxt_twin.recording.columns import SensorSlot, light_column, touch_column, ultrasonic_column

SweptSensor = Literal["ultrasonic", "light", "light_unlit", "touch"]
SweepPoint = tuple[float, ...]
"""A value for each of a sweep's axes."""


@final
@dataclass(frozen=True)
class SweepPart:
    """What becomes one recording.

    Attributes:
        name: of the recording, without suffix.
        places: where to go, in order.
        request: what a person has to prepare first; empty for nothing.
        until_silent: ends after a place at which no reading was valid.
        in_one_go: means nothing in pieces: half of it is done again from the beginning.
        other_pings: whether the second ultrasonic sensor is on; None without one.
    """

    name: str
    places: tuple[SweepPoint, ...]
    request: str = ""
    until_silent: bool = False
    in_one_go: bool = False
    other_pings: bool | None = None


@final
@dataclass(frozen=True)
class Sweep:
    """What to do with a sensor.

    Attributes:
        sensor: how it is read.
        slot: its port.
        axes: what is moved, in the order in which it is.
        parts: the recordings.
        samples: readings at each place.
        pace: how long to wait.
        other_slot: the port of a second ultrasonic sensor, if any.
    """

    sensor: SweptSensor
    slot: SensorSlot
    axes: tuple[PositionerAxis, ...]
    parts: tuple[SweepPart, ...]
    samples: int
    pace: Waits
    other_slot: SensorSlot | None = None

    @property
    def column(self) -> str:
        """The recordings' column with the sensor's readings."""
        match self.sensor:
            case "ultrasonic":
                return ultrasonic_column(self.slot)
            case "touch":
                return touch_column(self.slot)
            case _:
                return light_column(self.slot)

    @property
    def rig_columns(self) -> tuple[str, ...]:
        """The recordings' columns with the true values."""
        return tuple(f"rig_{axis}" for axis in self.axes)

    @property
    def places(self) -> int:
        """How many there are at most."""
        return sum(len(part.places) for part in self.parts)

    @property
    def least_duration_s(self) -> float:
        """How long waiting alone takes, without the moves."""
        readings = self.samples * max(self.pace.every_s, 0.003)
        return self.places * (self.pace.settle_s + readings)


def sweep_of(experiment: SensorExperiment) -> Sweep:
    """The experiment's places."""
    match experiment:
        case DistanceSweep():
            places = tuple((value,) for value in experiment.distance_mm.values())
            parts: tuple[SweepPart, ...] = (SweepPart("sweep", places),)
            return Sweep(
                "ultrasonic", experiment.slot, ("distance_mm",), parts, experiment.samples, experiment.pace
            )
        case AngleSweep():
            parts = tuple(
                SweepPart(
                    f"distance-{distance:06.1f}".replace(".0", ""),
                    tuple((distance, angle) for angle in experiment.angle_deg.values()),
                    until_silent=True,
                )
                for distance in experiment.distance_mm.values()
            )
            axes: tuple[PositionerAxis, ...] = ("distance_mm", "angle_deg")
            return Sweep("ultrasonic", experiment.slot, axes, parts, experiment.samples, experiment.pace)
        case GradientSweep():
            return _gradient(experiment)
        case TouchCycles():
            up = experiment.push.values()
            places = tuple((value,) for value in (*up, *reversed(up[:-1])))
            parts = tuple(
                SweepPart(f"cycle-{number + 1:03d}", places, in_one_go=True)
                for number in range(experiment.cycles)
            )
            return Sweep("touch", experiment.slot, (experiment.axis,), parts, 1, experiment.pace)
        case TwoSensors():
            return _two_sensors(experiment)


def _gradient(experiment: GradientSweep) -> Sweep:
    places = tuple((value,) for value in experiment.position_mm.values())
    several = len(experiment.lightings) > 1
    parts = tuple(
        SweepPart(f"light-{name}", places, request=f"Please set the room light '{name}'." if several else "")
        for name in experiment.lightings
    )
    sensor: SweptSensor = "light" if experiment.lamp else "light_unlit"
    return Sweep(sensor, experiment.slot, ("position_mm",), parts, experiment.samples, experiment.pace)


def _two_sensors(experiment: TwoSensors) -> Sweep:
    places = tuple((value,) for value in experiment.position_mm.values())
    parts = (SweepPart("alone", places, other_pings=False), SweepPart("together", places, other_pings=True))
    return Sweep(
        "ultrasonic",
        experiment.slot,
        ("position_mm",),
        parts,
        experiment.samples,
        experiment.pace,
        experiment.other_slot,
    )
