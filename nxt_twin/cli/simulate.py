"""`nxt-twin simulate`: run a plant freely over a recording's commands."""

from __future__ import annotations

import json as json_format
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nxt_twin.cli.compiling import tell_of_compiling
from nxt_twin.cli.output import JsonOption, emit_json
from nxt_twin.cli.tables import ColumnsOption, MappingOption, stated_mapping

if TYPE_CHECKING:
    from nxt_twin.api.prediction import SimulatedChannel
    from nxt_twin.recording.mappings import MappingOf
    from nxt_twin.recording.recording import Recording


def simulate(
    model: Annotated[str, typer.Argument(help="A plant: a YAML file, or the name of a built-in one.")],
    recording: Annotated[Path, typer.Argument(help="The recording that gives the inputs.")],
    mapping: MappingOption = None,
    columns: ColumnsOption = None,
    restart_every: Annotated[
        float | None, typer.Option(min=1e-3, help="Restart from the measured state every S seconds.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Write the prediction as a recording.")] = None,
    json: JsonOption = None,
) -> None:
    """Predict a recording's outputs from its inputs and first row alone, starting at rest.

    The command prints the error of the prediction; rows at which the state restarts do not count. Readings are
    optional: a table of `time_s` and `a_power_pct` is enough, and the motor then starts at 0 degrees.
    """
    from nxt_twin.recording.files import write_recording
    from nxt_twin.recording.recording import Recording

    source = _source(recording, stated_mapping(mapping, columns))
    tell_of_compiling()
    found = _predicted(model, source, restart_every)
    if out:
        whole = {**source.columns, **{each.channel: each.values for each in found}}
        write_recording(Recording(out.name, whole, kinds=source.kinds), out)
    if json:
        errors = [
            {"channel": each.channel, "rmse": each.rmse, "unit": each.unit, "readings": each.readings}
            for each in found
        ]
        emit_json(json, json_format.dumps({"schema": "nxt-twin/simulation/1", "errors": errors}))
    if json != "-":
        for each in found:
            print(_told(each))
        if out:
            print(f"prediction: {out}")


def _source(path: Path, mapping_of: MappingOf | None) -> Recording:
    from nxt_twin.api.files import read_recording

    mapping = mapping_of(path.name) if mapping_of else None
    if mapping is None:
        return read_recording(path)
    from nxt_twin.recording.mapped import read_mapped  # with the models of mappings: slow

    return read_mapped(path, mapping)


def _predicted(model: str, source: Recording, restart_every: float | None) -> tuple[SimulatedChannel, ...]:
    from nxt_twin.api.prediction import SimulatedChannel, predictions
    from nxt_twin.diagnose.sensor.runs import KINDS
    from nxt_twin.recording.case import ROBOT_KIND
    from nxt_twin.recording.configs import load_plant_config

    config = load_plant_config(model)
    if config.get("kind") == ROBOT_KIND:
        from nxt_twin.diagnose.robot.simulate import expected_pose  # a motor's prediction needs none of it

        return tuple(
            SimulatedChannel(one.channel, one.values, one.unit, one.rmse, one.readings)
            for one in expected_pose(config, source, restart_every)
        )
    if config.get("kind") not in KINDS:
        return predictions(config, source, restart_every)
    from nxt_twin.diagnose.sensor.simulate import expected_readings  # scipy takes 0.4 s to import

    said = expected_readings(config, source)
    rmse = said.rmse if said.readings else None
    return (SimulatedChannel(said.channel, said.values, said.unit, rmse, said.readings),)


def _told(each: SimulatedChannel) -> str:
    if each.rmse is None:
        return f"{each.channel}: predicted; the recording holds no readings to compare"
    return f"{each.channel}: free-run RMSE {each.rmse:.4g} {each.unit}, {each.readings} readings"
