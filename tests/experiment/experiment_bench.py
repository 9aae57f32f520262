"""A mock brick with a rig, and small experiments for it."""

from __future__ import annotations

from pathlib import Path
from typing import Any, final

from nxt_twin.brick.clock import Clock
from nxt_twin.experiment.folder import RunFolder
from nxt_twin.experiment.outline import axes_of
from nxt_twin.experiment.plan import _KINDS, Experiment
from nxt_twin.experiment.run_sweep import Apparatus, SweepProgress
from nxt_twin.experiment.standin.rig import RigMover
from nxt_twin.experiment.standin.workbench import Workbench, helper, place_sensors, workbench

FAST = {"settle_s": 0.05, "every_s": 0.05}

SMALL: dict[str, dict[str, Any]] = {
    "distance_sweep": {"distance_mm": {"first": 25, "last": 1465, "step": 30}, "samples": 2, "pace": FAST},
    "angle_sweep": {
        "distance_mm": {"first": 338, "last": 1338, "step": 500},
        "angle_deg": {"first": 0, "last": 90, "step": 5},
        "samples": 8,
        "pace": FAST,
    },
    "gradient_sweep": {
        "position_mm": {"first": 0, "last": 280, "step": 20},
        "lightings": ["dark", "lamp"],
        "samples": 4,
        "pace": {"settle_s": 0.01, "every_s": 0.004},
    },
    "touch_cycles": {
        "push": {"first": 45, "last": 65, "step": 1},
        "cycles": 3,
        "pace": {"settle_s": 0.01, "every_s": 0},
    },
    "two_sensors": {
        "position_mm": {"first": -40, "last": 40, "step": 2},
        "samples": 4,
        "pace": FAST,
    },
    "motor_identification": {
        "runs": [
            {"name": f"step{power}", "segments": [{"duration_s": 0.9, "power_pct": power}, coast]}
            for power in (100, 60, -80)
            for coast in ({"duration_s": 0.5, "mode": "coast"},)
        ],
        "rest_s": 0.2,
    },
}


@final
class Impatient:
    """A clock at which somebody presses Ctrl-C from `until_s` on."""

    def __init__(self, clock: Clock, until_s: float) -> None:
        self._clock = clock
        self._until_s = until_s

    def now_s(self) -> float:
        return self._clock.now_s()

    def sleep(self, duration_s: float) -> None:
        self._clock.sleep(duration_s)
        if self.now_s() > self._until_s:
            raise KeyboardInterrupt


def small(kind: str, **changes: Any) -> Experiment:
    return _KINDS[kind].model_validate({"kind": kind, "name": f"small {kind}", **SMALL[kind], **changes})


def bench_for(experiment: Experiment, seed: int = 1, profile: str = "none") -> Workbench:
    bench = workbench(seed=seed, profile=profile)
    place_sensors(bench, experiment)
    return bench


def surroundings(
    bench: Workbench, experiment: Experiment, told: list[SweepProgress] | None = None
) -> Apparatus:
    movers = {axis: RigMover(bench.rig, axis) for axis in axes_of(experiment)}
    tell = (lambda _: None) if told is None else told.append
    return Apparatus(bench.brick, bench.clock, movers, helper(bench, experiment), tell)


def rows_of(folder: Path, name: str) -> list[str]:
    return (folder / "recordings" / f"{name}.csv").read_text().splitlines()


def new_folder(path: Path, experiment: Experiment) -> RunFolder:
    return RunFolder(path / "run", experiment)
