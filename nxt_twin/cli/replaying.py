"""Play a recording beside a model, for `replay`."""

from __future__ import annotations

import math
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

from nxt_twin.brick.clock import PacedClock, SystemClock
from nxt_twin.brick.links.recorded import RecordedBrick
from nxt_twin.cli.lingering import linger
from nxt_twin.cli.output import progress
from nxt_twin.cli.showing import Showing
from nxt_twin.cli.wanted import wanted_ports
from nxt_twin.cli.watching import audience, conclude_watch, get_ready, watch
from nxt_twin.errors import RecordingError
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.files import read_recording
from nxt_twin.twin.adopt import AtOnce
from nxt_twin.twin.beside import diagnosing
from nxt_twin.twin.replayed import replay_sitting, sensors_of
from nxt_twin.twin.sensor_twin import SensorTwin

_DEFAULT_PLANT: Final = "nxt_motor"


@final
@dataclass(frozen=True)
class ReplayArguments:
    """The command line's arguments for a replay.

    Attributes:
        model: of the motors: a name or a YAML file; None: the sidecar's, or `nxt_motor`.
        ports: of the motors, such as `ab`; None: every recorded motor.
        speed: as a multiple of real time; 0: as fast as possible.
        adopt: whether a diagnosis of a divergence replaces the model.
    """

    model: str | None
    ports: str | None
    speed: float
    adopt: bool


def replay_beside(recording: Path, asked: ReplayArguments, showing: Showing) -> None:
    """Play a recording to the live twin, and show what `showing` names.

    Raises:
        RecordingError: the file is no recording of a brick, or lacks the motors.
        PlantError: the model is no motor.
        typer.BadParameter: `asked.ports` names no motors.
    """
    played = read_recording(recording)
    plant = plant_from_config(load_plant_config(asked.model or played.plant or _DEFAULT_PLANT), "power_pct")
    get_ready({"a": plant}, adopting=asked.adopt)
    clock = PacedClock(SystemClock(), asked.speed or math.inf)
    recorded = RecordedBrick(played, clock).ports
    chosen = recorded if asked.ports is None else wanted_ports(asked.ports)
    watched = tuple(port for port in chosen if port in recorded)
    if not watched:
        raise RecordingError(
            "holds none of these motors", where=str(recording), mend="name recorded motors with --ports"
        )
    channels = [SensorTwin(slot, kind).column for slot, kind in sensors_of(played).items()]
    told = audience(watched, channels, showing)
    beside: Executor = diagnosing() if asked.speed > 0.0 else AtOnce()
    sitting, duration_s = replay_sitting(
        played, dict.fromkeys(watched, plant), clock, told.sink(), beside if asked.adopt else None
    )
    with progress("replay"):
        ended = watch(sitting, duration_s, told)
    conclude_watch(sitting.outcome(), told, showing)
    linger(told.dashboards, until_interrupted=ended)
