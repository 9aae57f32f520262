"""`nxt-twin fit`: fit a plant's parameters as it stands, looking for nothing else."""

from __future__ import annotations

import json as json_format
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
import yaml

from nxt_twin.cli.compiling import tell_of_compiling
from nxt_twin.cli.output import JsonOption, emit_json, progress, remark
from nxt_twin.cli.tables import ColumnsOption, MappingOption, stated_mapping
from nxt_twin.diagnose.engine import fit_as_it_stands
from nxt_twin.diagnose.robot.engine import fit_robot, is_robot_case
from nxt_twin.diagnose.sensor.engine import is_sensor_case
from nxt_twin.diagnose.sensor.fit import fit_sensor
from nxt_twin.recording.case import Case, read_as_case


def fit(
    path: Annotated[Path, typer.Argument(help="A case folder or a recording.")],
    mapping: MappingOption = None,
    columns: ColumnsOption = None,
    json: JsonOption = None,
    model_out: Annotated[Path | None, typer.Option(help="Write the fitted plant as YAML.")] = None,
) -> None:
    """Fit the parameters of a case's plant to its recordings, except those it holds out."""
    case = read_as_case(path, stated_mapping(mapping, columns))
    remark(case)
    if is_sensor_case(case):
        _show_sensor(case, json, model_out)
        return
    if is_robot_case(case):
        _show_robot(case, json, model_out)
        return
    tell_of_compiling()
    with progress(str(path)):
        structure = fit_as_it_stands(case)
    plant, fitted = structure.plant, structure.fitted
    stds = np.sqrt(np.maximum(np.diag(fitted.covariance), 0.0))
    rows = []
    for variable, std in zip(fitted.variables, stds, strict=True):
        for slot, ratio in zip(variable.slots, variable.ratios, strict=True):
            parameter = plant.layout.parameters[slot]
            value = plant.values[slot] / parameter.si
            name = parameter.name if slot.owner == "base" else f"{slot.owner}.{parameter.name}"
            rows.append(
                {"name": name, "value": value, "std": std * ratio / parameter.si, "unit": parameter.unit}
            )
    if model_out:
        model_out.write_text(yaml.safe_dump(plant.to_config(), sort_keys=False), encoding="utf-8")
    _show(rows, json)


def _show_sensor(case: Case, json: str | None, model_out: Path | None) -> None:
    """Fit a sensor, and show and write what came out."""
    with progress(case.name):
        fitted = fit_sensor(case)
    if model_out and fitted.config:
        model_out.write_text(yaml.safe_dump(dict(fitted.config), sort_keys=False), encoding="utf-8")
    _show([asdict(value) for value in fitted.values], json)


def _show_robot(case: Case, json: str | None, model_out: Path | None) -> None:
    """Fit a robot's wheels, track and markers, and show and write what came out."""
    with progress(case.name):
        values, model = fit_robot(case)
    if model_out:
        model_out.write_text(yaml.safe_dump(model.to_config(), sort_keys=False), encoding="utf-8")
    _show([{"name": name, **value} for name, value in values.items()], json)


def _show(rows: list[dict[str, Any]], json: str | None) -> None:
    if json:
        emit_json(json, json_format.dumps({"schema": "nxt-twin/fit/1", "parameters": rows}))
    if json != "-":
        for row in rows:
            print(f"{row['name']} = {row['value']:.5g} ± {row['std']:.2g} {row['unit']}")
