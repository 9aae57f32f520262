"""From any case to a diagnosis, or to what changed: a motor's or an axis', a sensor's, or a robot's on two wheels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, final

from nxt_twin.diagnose.changed.answer import Changes
from nxt_twin.diagnose.changed.compare import changed
from nxt_twin.diagnose.diagnosis import Diagnosis
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.diagnose.robot.engine import diagnose_robot, is_robot_case
from nxt_twin.diagnose.robot_changed.compare import robots_changed
from nxt_twin.diagnose.sensor.engine import diagnose_sensor, is_sensor_case
from nxt_twin.recording.case import Case


@final
@dataclass(frozen=True)
class Answered:
    """A diagnosis, and the keys of the improved plant, sensor or robot."""

    diagnosis: Diagnosis
    model: dict[str, Any]


def diagnose_any(
    case: Case,
    *,
    seed: int = 0,
    tolerance: float | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Answered:
    """Diagnose a case by the engine for what it is about.

    Args:
        case: of a motor, an axis, a sensor or a robot.
        seed: of the random shifts behind p-values.
        tolerance: error that does not matter, SI: of a simulation; of a robot's position. Sensors have none.
        progress: told in words what is being done.

    Raises:
        NxtTwinError: the case cannot be diagnosed; its text says why.
    """
    if is_sensor_case(case):
        told = diagnose_sensor(case, seed=seed, progress=progress)
        return Answered(told.diagnosis, told.model.to_config())
    if is_robot_case(case):
        driven = diagnose_robot(case, tolerance_m=tolerance, progress=progress)
        return Answered(driven.diagnosis, driven.model.to_config())
    answer = diagnose(case, seed=seed, tolerance=tolerance, progress=progress)
    return Answered(answer.diagnosis, answer.plant.to_config())


def changed_any(
    before: Case,
    afters: Sequence[Case],
    *,
    tolerance: float | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> list[Changes]:
    """Compare sides by the engine for what they are about.

    Args:
        before: of a motor, an axis or a robot; its plant is the model of all sides.
        afters: their plants play no part.
        tolerance: error of a simulation that does not matter, SI; only of motors and axes.
        progress: told in words what is being done.

    Raises:
        NxtTwinError: a side cannot be compared; its text says why.
    """
    if is_robot_case(before):
        return robots_changed(before, afters, progress)
    return changed(before, afters, tolerance=tolerance, progress=progress)


def changed_since(
    case: Case, *, tolerance: float | None = None, progress: Callable[[str], None] = lambda _: None
) -> Changes:
    """As `changed_any`, between the recordings that `case` calls `before` and its own.

    Raises:
        NxtTwinError: the sides cannot be compared; its text says why.
    """
    before = replace(case, name="before", recordings=case.before, holdout=(), before=())
    return changed_any(before, [case], tolerance=tolerance, progress=progress)[0]
