"""`nxt-twin simulate`: run a plant freely over a recording's inputs."""

from __future__ import annotations

import json as json_format
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from nxt_twin.arrays import FloatArray
from nxt_twin.cli.output import JsonOption, emit_json
from nxt_twin.diagnose.sensor.simulate import expected_readings, is_sensor_model
from nxt_twin.diagnose.units import units_of
from nxt_twin.errors import RecordingError
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.recorded import signals_of
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Simulator, free_job, with_supply
from nxt_twin.physics.start import Start, at_rest, restarts
from nxt_twin.recording.columns import PORTS, power_column, tacho_column
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.files import read_recording, write_recording
from nxt_twin.recording.mapping import read_mapped, read_mapping
from nxt_twin.recording.recording import Recording


def simulate(
    model: Annotated[str, typer.Argument(help="A plant: a YAML file, or the name of one that comes along.")],
    recording: Annotated[Path, typer.Argument(help="The recording whose inputs to run it on.")],
    mapping: Annotated[Path | None, typer.Option(help="Mapping file for a table from elsewhere.")] = None,
    restart_every: Annotated[
        float | None, typer.Option(min=1e-3, help="Set the state anew from the measurement every so many s.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Write the prediction as a recording.")] = None,
    json: JsonOption = None,
) -> None:
    """Predict a recording's outputs from its inputs and first row alone, at rest; or anew every so many seconds.

    Prints the error against what was recorded. Rows at which the state is set anew are not counted in it.
    """
    source = read_mapped(recording, read_mapping(mapping)) if mapping else read_recording(recording)
    config = load_plant_config(model)
    predicted: dict[str, FloatArray] = {}
    errors = []
    if is_sensor_model(config):
        said = expected_readings(config, source)
        predicted[said.channel] = said.values
        errors.append(
            {"channel": said.channel, "rmse": said.rmse, "unit": said.unit, "readings": said.readings}
        )
    for port in () if is_sensor_model(config) else _ports(source):
        signals = signals_of(source, port)
        start, values = _run(config, signals, restart_every)
        factor = units_of("motor", signals).reading_factor if signals.channel != "output" else 1.0
        predicted[signals.channel] = values * factor
        errors.append({"channel": signals.channel, **_error(signals, start, values)})
    if out:
        write_recording(Recording(out.name, {**source.columns, **predicted}, kinds=source.kinds), out)
    if json:
        emit_json(json, json_format.dumps({"schema": "nxt-twin/simulation/1", "errors": errors}))
    if json != "-":
        for error in errors:
            print(
                f"{error['channel']}: free-run RMSE {error['rmse']:.4g} {error['unit']}, {error['readings']} readings"
            )
        if out:
            print(f"prediction: {out}")


def _run(
    config: dict[str, object], signals: Signals, restart_every: float | None
) -> tuple[Start, FloatArray]:
    plant = plant_from_config(config, signals.input_kind)
    supplied = with_supply(signals, plant)
    start = at_rest(supplied) if restart_every is None else restarts(supplied, restart_every)
    with Simulator(plant.layout, workers=1) as simulator:
        return start, simulator.trace(plant, free_job(supplied, start))["predicted"]


def _ports(recording: Recording) -> list[str | None]:
    if recording.kinds:
        return [None]
    columns = recording.columns
    found = [p for p in PORTS if power_column(p) in columns and tacho_column(p) in columns]
    if not found:
        raise RecordingError(
            "no port has both power and tacho",
            where=recording.name,
            mend="record a_power_pct and a_tacho_deg",
        )
    return list(found)


def _error(signals: Signals, start: Start, predicted: FloatArray) -> dict[str, object]:
    counted = np.isfinite(signals.measured) & ~start.at
    linear = signals.input_kind == "force_n"
    units = units_of("linear" if linear else "motor", signals)
    rmse = float(np.sqrt(np.mean((signals.measured - predicted)[counted] ** 2))) * units.reading_factor
    return {"rmse": rmse, "unit": units.reading, "readings": int(counted.sum())}
