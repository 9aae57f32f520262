"""A run in a robot's world: what watches it, and what is written of it afterwards."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import final

import numpy as np
import yaml

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.robot.drive import DifferentialDrive, drive_from_config
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.view.dashboard.drawing.world_view import WorldView
from nxt_twin.world.arena import Arena
from nxt_twin.world.film import VIDEO, Film, refuse_unknown
from nxt_twin.world.floor import FloorPicture
from nxt_twin.world.ghost import ghost_of
from nxt_twin.world.motion import Motion
from nxt_twin.world.outcome import Ghost, WorldOutcome, outcome
from nxt_twin.world.program import Ran
from nxt_twin.world.trace import Trace

_PICTURES_PER_S, _VIDEO_PER_S = 10, 20


@final
@dataclass(frozen=True)
class Wanted:
    """The files that a run writes; None writes none.

    Attributes:
        trace: the robot's course as a recording; with a ghost, its sidecar names the plant.
        film: a film of it.
        save: all that moved, for rerun.
        ghost: a `differential_drive` plant, by name or file: where the encoders alone have the robot.
    """

    trace: Path | None = None
    film: Path | None = None
    save: Path | None = None
    ghost: str | None = None


@final
class Watched:
    """Watches a world from now on.

    Args:
        arena: the robot in its scene.
        wanted: what is to be kept.

    Raises:
        WorldError: the film's name says no format, or its writer is not installed.
        PlantError: the ghost's plant is none.
        NxtTwinError: a view is wanted, and rerun is not installed.
    """

    def __init__(self, arena: Arena, wanted: Wanted) -> None:
        self._arena, self._wanted = arena, wanted
        self._drive: DifferentialDrive | None = None
        if wanted.ghost is not None:
            self._drive = drive_from_config(load_plant_config(wanted.ghost))
        self._film: Film | None = None
        if wanted.film is not None:
            refuse_unknown(wanted.film)
            per_second = _VIDEO_PER_S if wanted.film.suffix.lower() == VIDEO else _PICTURES_PER_S
            self._film = Film(arena, per_second=per_second)
        self._view = None if wanted.save is None else WorldView(wanted.save, arena.setting.robot.name)
        self._motion = None if self._view is None else Motion(arena)
        self._course = Trace(arena)

    def concluded(self, ran: Ran, *, wall_s: float) -> WorldOutcome:
        """What became of the robot; all that is wanted is written."""
        course, wanted = self._course, self._wanted
        ghost = None if self._drive is None else ghost_of(course, self._drive)
        if wanted.trace is not None:
            course.write(wanted.trace)
            _name_plant(wanted.trace, wanted.ghost)
        if wanted.film is not None and self._film is not None:
            self._film.write(wanted.film)
        self._save(ghost)
        return outcome(self._arena, course, ran, wall_s=wall_s, ghost=None if ghost is None else _last(ghost))

    def _save(self, ghost: FloatArray | None) -> None:
        view, motion, arena = self._view, self._motion, self._arena
        if view is None or motion is None:
            return
        floor = arena.setting.scene.floor
        shades = FloorPicture(floor, arena.setting.file).shades
        view.floor(shades, (1e-3 * floor.size_mm[0], 1e-3 * floor.size_mm[1]))
        bodies = motion.bodies()
        view.bodies(motion.time_s, bodies)
        view.echoes(motion.time_s, motion.rays_m)
        view.way(self._course.places_m)
        if ghost is not None:
            robot = [body for body in bodies if body.name.startswith("robot/")]
            view.ghost(self._course.column("time_s"), ghost, robot)
        view.close()


def _name_plant(recording: Path, plant: str | None) -> None:
    """Name the model of a written recording in its sidecar, so that it can be diagnosed; a file that is there stays."""
    sidecar = recording.with_suffix(".yaml")
    if plant is None or sidecar.exists():
        return
    file = Path(plant)
    sidecar.write_text(yaml.safe_dump({"plant": str(file.resolve()) if file.is_file() else plant}), "utf-8")


def _last(ghost: FloatArray) -> Ghost:
    x, y, heading = ghost[-1].tolist()
    return Ghost(x, y, float(np.degrees(heading)))
