"""What moves things round a mock brick: at once by the rig, or as asked for - a rail, a robot - made of software."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from nxt_twin.experiment.positioner.nx100 import Nx100Robot, RobotSetUp
from nxt_twin.experiment.positioner.nx100_session import Nx100Session
from nxt_twin.experiment.positioner.positioner import Positioner, PositionerAxis
from nxt_twin.experiment.positioner.rail import Rail, RailSetUp
from nxt_twin.experiment.positioner.spec import PositionerSpec
from nxt_twin.experiment.standin.nx100 import InMemoryWire, Nx100Standin, RobotState
from nxt_twin.experiment.standin.rig import Carriage, RigMover
from nxt_twin.experiment.standin.workbench import Workbench
from nxt_twin.recording.columns import PORTS

_COORDINATES: Final = ("x", "y", "z", "rx", "ry", "rz")


def standin_positioners(
    bench: Workbench, specs: Mapping[PositionerAxis, PositionerSpec]
) -> Mapping[PositionerAxis, Positioner]:
    """A stand-in for each positioner that was asked for; a hand's is the rig itself."""
    return {axis: _mover(bench, axis, spec) for axis, spec in specs.items()}


def _mover(bench: Workbench, axis: PositionerAxis, spec: PositionerSpec) -> Positioner:
    match spec.set_up:
        case RailSetUp() as set_up:
            port = PORTS.index(spec.address)
            carriage = Carriage(bench.body, port, set_up.mm_per_deg, set_up.play_deg, set_up.home_value)
            bench.rig.follow(axis, carriage.place_mm)
            return Rail(bench.brick, port, set_up, axis, bench.clock)
        case RobotSetUp() as set_up:
            return _robot(bench, axis, set_up)
        case None:
            return RigMover(bench.rig, axis)


def _robot(bench: Workbench, axis: PositionerAxis, set_up: RobotSetUp) -> Positioner:
    robot = RobotState(bench.clock)
    index, start = _COORDINATES.index(set_up.along), robot.pose
    bench.rig.follow(axis, lambda: set_up.value_now + set_up.sign * (robot.now()[index] - start[index]))
    return Nx100Robot(Nx100Session(InMemoryWire(Nx100Standin(robot))), set_up, axis, bench.clock)
