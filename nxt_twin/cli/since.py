"""`live --since`: what differs on each motor since its plant was identified, for a person and as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import typer

from nxt_twin.cli.output import progress
from nxt_twin.diagnose.changed.answer import Changes
from nxt_twin.diagnose.changed.to_json import to_json
from nxt_twin.errors import NxtTwinError
from nxt_twin.physics.plant import Plant, plant_from_config
from nxt_twin.recording.columns import Port
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.twin.outcome import Sitting


@final
@dataclass(frozen=True)
class Differing:
    """What differs on each motor: its changes, or why they cannot be told."""

    found: Mapping[Port, Changes | str]

    def lines(self) -> list[str]:
        """One line for each motor, and its notes."""
        return [line for port, found in self.found.items() for line in _lines(port, found)]

    def document(self) -> dict[Port, Any]:
        """The changes of each motor as JSON."""
        return {
            port: {"refused": found} if isinstance(found, str) else json.loads(to_json(found))
            for port, found in self.found.items()
        }

    def pages(self, folder: Path) -> list[str]:
        """Write a page for each motor that was compared."""
        from nxt_twin.view.changes_report import write_changes_report

        told = [found for found in self.found.values() if not isinstance(found, str)]
        return [str(write_changes_report(found, folder)) for found in told]


def plants_since(name: str, ports: tuple[Port, ...]) -> dict[Port, Plant]:
    """The plant of each motor: `NAME-a.yaml` for port A, as `live --model-out NAME.yaml` writes it, else `NAME.yaml`.

    Raises:
        PlantError: there is no such plant, or it is none of a motor.
    """
    return {port: plant_from_config(load_plant_config(_own(name, port)), "power_pct") for port in ports}


def differing(sitting: Sitting, name: str, plants: Mapping[Port, Plant]) -> Differing:
    """Compare what a session saw of each motor with its plant of then."""
    found: dict[Port, Changes | str] = {}
    with progress("comparing") as tell:
        for port, plant in plants.items():
            tell(f"comparing port {port.upper()} with {name}")
            try:
                found[port] = sitting.since(port, Path(name).name, plant).changes()
            except NxtTwinError as error:
                found[port] = str(error)
    return Differing(found)


def one_model(since: str | None, plant: str | None) -> str | None:
    """The model of the motors, which only one of the two options may name.

    Raises:
        typer.BadParameter: both options are given.
    """
    if since is not None and plant is not None:
        raise typer.BadParameter("--since names the model of the motors; leave --plant out")
    return since or plant


def _own(name: str, port: Port) -> str:
    path = Path(name)
    own = path.with_stem(f"{path.stem}-{port}")
    return str(own) if path.suffix and own.exists() else name


def _lines(port: Port, found: Changes | str) -> list[str]:
    if isinstance(found, str):
        return [f"not compared: {found}"]
    supply = [f"  · {note}" for note in found.notes if note.startswith("the supply was")]
    return [f"since {found.before}, port {port.upper()}: {found.verdict}. {found.sentence}", *supply]
