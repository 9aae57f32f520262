"""Run a plant freely over the commands of a recording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from nxt_twin.api.files import ModelSource, load_plant
from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.units import units_of
from nxt_twin.errors import RecordingError
from nxt_twin.physics.base.servo import SERVO
from nxt_twin.physics.effects.timing import CLOCK_SKEW
from nxt_twin.physics.goals import follower
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.recorded import signals_of
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Simulator, free_job, with_supply
from nxt_twin.physics.start import Start, at_rest, restarts
from nxt_twin.recording.columns import PORTS, goal_column, power_column
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.recording import InputKind, Recording


@final
@dataclass(frozen=True)
class SimulatedChannel:
    """The prediction of one output channel, for a port's commands or a mapped recording.

    Attributes:
        channel: the column.
        values: shape (rows,), in the column's unit.
        unit: of the error.
        rmse: root mean square error against the readings, in `unit`; None without readings.
        readings: number of compared readings; those from which a run starts do not count.
    """

    channel: str
    values: FloatArray
    unit: str
    rmse: float | None
    readings: int


def simulate(plant: ModelSource, recording: Recording, *, restart_every_s: float | None = None) -> Recording:
    """Predict a recording's outputs from its inputs and its first row alone, starting at rest.

    Args:
        plant: a plant, a name, a path or a mapping, as for `load_plant`.
        recording: its inputs drive the plant. Readings are optional: without any, motors start at 0 degrees.
        restart_every_s: time between restarts from smoothed readings, s; None never restarts.

    Returns:
        The recording with the predictions as its output columns, in their units, shape (rows,) each.

    Raises:
        PlantError: the model is no plant, or cannot be driven so.
        RecordingError: the recording holds no command.

    >>> import nxt_twin as nt
    >>> mine = nt.Recording("mine", {"time_s": [0.0, 0.5, 1.0, 1.5], "a_power_pct": [50, 50, 0, 0]})
    >>> nt.simulate("nxt_motor", mine).columns["a_tacho_deg"].round()
    array([  0., 198., 411., 424.])
    """
    found = predictions(plant, recording, restart_every_s)
    columns = {**recording.columns, **{each.channel: each.values for each in found}}
    return Recording(recording.name, columns, kinds=recording.kinds)


def predictions(
    plant: ModelSource, recording: Recording, restart_every_s: float | None = None
) -> tuple[SimulatedChannel, ...]:
    """The prediction for each port that is driven, or for a mapped recording's output, with its error.

    Raises:
        PlantError: the model is no plant, or cannot be driven so.
        RecordingError: the recording holds no command.
    """
    return tuple(_predicted(plant, recording, port, restart_every_s) for port in _driven(recording))


def _predicted(
    plant: ModelSource, recording: Recording, port: str | None, every_s: float | None
) -> SimulatedChannel:
    signals = signals_of(recording, port, fewest_readings=0, follows_goal=_is_servo(plant))
    driven = _followed(plant, recording, port, signals.input_kind)
    start, values = _run(driven, _stamped(driven, signals), every_s)
    units = units_of("linear" if signals.input_kind == "force_n" else "motor", signals)
    factor = units.reading_factor if signals.channel != "output" else 1.0
    counted = np.isfinite(signals.measured) & ~start.at
    rmse = None
    if counted.any():
        rmse = float(np.sqrt(np.mean((signals.measured - values)[counted] ** 2))) * units.reading_factor
    return SimulatedChannel(signals.channel, values * factor, units.reading, rmse, int(counted.sum()))


def _stamped(plant: Plant, signals: Signals) -> Signals:
    """The signals with how late each row was stamped, where the plant's clock makes rows late by chance."""
    if CLOCK_SKEW.id not in plant.active:
        return signals
    # Linear algebra takes longer to import than all else that a prediction needs.
    from nxt_twin.diagnose.fitting.late_rows import as_late_as

    return as_late_as(plant, signals)


def _followed(model: ModelSource, recording: Recording, port: str | None, kind: InputKind) -> Plant:
    """The plant, with the firmware's regulator where that drives the motor."""
    config = _config(model)
    followed = follower(config, [recording], port)
    return load_plant(model if followed is config else followed, kind)


def _config(model: ModelSource) -> Mapping[str, Any]:
    """The keys of a plant."""
    if isinstance(model, Plant):
        return model.to_config()
    return model if isinstance(model, Mapping) else load_plant_config(model)


def _is_servo(model: ModelSource) -> bool:
    return _config(model).get("kind") == SERVO.kind


def _run(plant: Plant, signals: Signals, every_s: float | None) -> tuple[Start, FloatArray]:
    supplied = with_supply(signals, plant)
    start = at_rest(supplied) if every_s is None else restarts(supplied, every_s)
    with Simulator(plant.layout, workers=1) as simulator:
        return start, simulator.trace(plant, free_job(supplied, start))["predicted"]


def _driven(recording: Recording) -> list[str | None]:
    if recording.kinds:
        return [None]
    commands = (power_column, goal_column)
    found = [port for port in PORTS if any(column(port) in recording.columns for column in commands)]
    if not found:
        mend = "give it a_power_pct"
        raise RecordingError("commands no port", where=recording.name, mend=mend)
    return list(found)
