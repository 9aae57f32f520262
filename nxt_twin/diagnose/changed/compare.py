"""What has changed between cases: the one function that commands call."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from nxt_twin.diagnose.changed.answer import Changes
from nxt_twin.diagnose.changed.engine import Progress, compare
from nxt_twin.diagnose.changed.telling import told
from nxt_twin.errors import DiagnosisError
from nxt_twin.recording.case import ROBOT_KIND, Case
from nxt_twin.recording.configs import load_plant_config


def changed(
    before: Case,
    afters: Sequence[Case],
    *,
    tolerance: float | None = None,
    progress: Progress = lambda _: None,
) -> list[Changes]:
    """Say for each of `afters` which parameters or effects differ from `before`, if any.

    Args:
        before: its plant is the model of all sides.
        afters: their plants play no part.
        tolerance: error of a simulation that does not matter, SI (rad, m, or per second). None takes half a
            step of the encoder, or the roughness of its readings.
        progress: told in words what is being done.

    Raises:
        NxtTwinError: a side cannot be compared; its text says why.
    """
    plant = load_plant_config(before.plant) if isinstance(before.plant, str) else before.plant
    if plant.get("kind") == ROBOT_KIND:
        mend = "run diagnose on each side, and compare the parameters"
        raise DiagnosisError("a robot's recordings cannot be compared yet", where=before.name, mend=mend)
    return [told(each) for each in compare(before, afters, tolerance, progress)]


def changed_since(
    case: Case, *, tolerance: float | None = None, progress: Progress = lambda _: None
) -> Changes:
    """As `changed`, between the recordings that `case` calls `before` and its own.

    Raises:
        NxtTwinError: the sides cannot be compared; its text says why.
    """
    before = replace(case, name="before", recordings=case.before, holdout=(), before=())
    return changed(before, [case], tolerance=tolerance, progress=progress)[0]
