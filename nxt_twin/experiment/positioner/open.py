"""Open the positioners that a user asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import Clock
from nxt_twin.experiment.errors import ExperimentError, PositionerError
from nxt_twin.experiment.positioner.by_hand import Ask, ByHand
from nxt_twin.experiment.positioner.nx100 import Nx100Robot, RobotSetUp
from nxt_twin.experiment.positioner.nx100_session import Nx100Session, Nx100Wire, TcpWire
from nxt_twin.experiment.positioner.positioner import Positioner, PositionerAxis
from nxt_twin.experiment.positioner.rail import Rail, RailSetUp
from nxt_twin.experiment.positioner.spec import PositionerSpec
from nxt_twin.recording.columns import PORTS

Connect = Callable[[str, int], Nx100Wire]
"""Connects to a robot's controller."""


def assigned(
    specs: Sequence[PositionerSpec], axes: Sequence[PositionerAxis]
) -> Mapping[PositionerAxis, PositionerSpec]:
    """Which positioner moves which axis; a hand moves what no other does.

    Raises:
        ExperimentError: an axis is moved by two, or one that the experiment has not.
    """
    found: dict[PositionerAxis, PositionerSpec] = {}
    for spec in specs:
        wanted = [spec.axis] if spec.axis else [axis for axis in axes if axis not in found][:1]
        for axis in wanted:
            if axis not in axes or axis in found:
                what = "is moved by two positioners" if axis in found else "is not moved in this experiment"
                raise ExperimentError(what, where=axis, mend=f"it moves {', '.join(axes) or 'nothing'}")
            found[axis] = spec
        if not wanted:
            mend = f"it moves {', '.join(axes) or 'nothing'}"
            raise ExperimentError(f"nothing is left to move for {spec.kind}", where="positioners", mend=mend)
    return {axis: found.get(axis, PositionerSpec("hand")) for axis in axes}


def open_positioners(
    specs: Mapping[PositionerAxis, PositionerSpec],
    brick: Brick,
    clock: Clock,
    ask: Ask,
    connect: Connect = TcpWire,
) -> Mapping[PositionerAxis, Positioner]:
    """Open all of them; if one cannot be, those that were are closed.

    Raises:
        PositionerError: a rail or robot is not ready, or cannot be reached.
    """
    opened: dict[PositionerAxis, Positioner] = {}
    try:
        for axis, spec in specs.items():
            opened[axis] = _open(axis, spec, brick, clock, ask, connect)
    except BaseException:
        close_positioners(opened)
        raise
    return opened


def close_positioners(positioners: Mapping[PositionerAxis, Positioner]) -> None:
    """Stop and close all of them, whatever one of them says."""
    for positioner in positioners.values():
        with suppress(PositionerError):
            positioner.close()


def _open(
    axis: PositionerAxis, spec: PositionerSpec, brick: Brick, clock: Clock, ask: Ask, connect: Connect
) -> Positioner:
    match spec.set_up:
        case RailSetUp() as rail:
            return Rail(brick, PORTS.index(spec.address), rail, axis, clock)
        case RobotSetUp() as robot:
            where = f"nx100:{spec.address}:{spec.port}"
            session = Nx100Session(connect(spec.address, spec.port), where)
            return Nx100Robot(session, robot, axis, clock)
        case None:
            return ByHand(axis, ask)
