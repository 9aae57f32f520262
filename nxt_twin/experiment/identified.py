"""The result of an experiment: values, their uncertainty, and the anchors that they rest on."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, final

import yaml

SCHEMA: Final = "nxt-twin/identified/1"
NORMAL_95: Final = 1.959964
"""Half the width of a normal distribution's 95 % interval in standard deviations."""


@final
@dataclass(frozen=True)
class Value:
    """One identified parameter.

    Attributes:
        name: with its unit, as in plant and sensor files where it stands there.
        value: the likeliest, or the mean.
        std: standard deviation.
        low, high: 95 % interval.
        unit: for people.
        rests_on: what else has to be true for it, such as a resistance that was given; empty for nothing.
    """

    name: str
    value: float
    std: float
    low: float
    high: float
    unit: str
    rests_on: str = ""

    def covers(self, truth: float) -> bool:
        """Whether the 95 % interval holds `truth`."""
        return self.low <= truth <= self.high


def normal_value(name: str, value: float, std: float, unit: str, rests_on: str = "") -> Value:
    """A value with the interval of a normal distribution."""
    return Value(name, value, std, value - NORMAL_95 * std, value + NORMAL_95 * std, unit, rests_on)


@final
@dataclass(frozen=True)
class Identified:
    """The result of an experiment.

    Attributes:
        experiment: its kind.
        values: the parameters.
        compared: values got in another way, for comparison; in no configuration.
        notes: what a person should know, one sentence each.
        config: the plant or sensor, as for a YAML file; None where there is no such thing.
        recordings: files of the run's folder that a diagnosis of the plant or sensor would be about.
    """

    experiment: str
    values: tuple[Value, ...]
    compared: tuple[Value, ...] = ()
    notes: tuple[str, ...] = ()
    config: Mapping[str, Any] | None = field(default=None)
    recordings: tuple[str, ...] = ()

    def value(self, name: str) -> Value:
        """A parameter by name."""
        return next(value for value in (*self.values, *self.compared) if value.name == name)

    def to_json(self) -> str:
        """As JSON text, schema `nxt-twin/identified/1`."""
        document = {
            "schema": SCHEMA,
            "experiment": self.experiment,
            "values": [_as_json(value) for value in self.values],
            "compared": [_as_json(value) for value in self.compared],
            "notes": list(self.notes),
            "config": self.config,
        }
        return json.dumps(document, indent=2, ensure_ascii=False)

    def write(self, folder: Path) -> tuple[Path, ...]:
        """Write `identified.json`, `plant.yaml` or `sensor.yaml` where there is a configuration, and the case."""
        written = [folder / "identified.json"]
        written[0].write_text(self.to_json() + "\n", encoding="utf-8")
        if self.config is not None:
            name = "sensor" if str(self.config["kind"]).endswith("_sensor") else "plant"
            path = folder / f"{name}.yaml"
            text = yaml.safe_dump(dict(self.config), sort_keys=False, allow_unicode=True)
            path.write_text(_header(self) + text, encoding="utf-8")
            written.append(path)
            if self.recordings:
                written.append(folder / "case.yaml")
                case = {"plant": path.name, "recordings": list(self.recordings)}
                written[-1].write_text(yaml.safe_dump(case, sort_keys=False), encoding="utf-8")
        return tuple(written)


def _header(identified: Identified) -> str:
    """Comments with the uncertainties, which the keys have no room for."""
    lines = [f"# Identified by the experiment {identified.experiment}; ± is one standard deviation."]
    for value in identified.values:
        rests = f" (rests on {value.rests_on})" if value.rests_on else ""
        lines.append(f"#   {value.name}: {value.value:.6g} ± {value.std:.2g} {value.unit}{rests}")
    return "\n".join(lines) + "\n"


def _as_json(value: Value) -> dict[str, Any]:
    return {
        "name": value.name,
        "value": value.value,
        "std": value.std,
        "interval_95": [value.low, value.high],
        "unit": value.unit,
        "rests_on": value.rests_on,
    }
