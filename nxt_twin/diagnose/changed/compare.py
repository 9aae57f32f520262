"""What has changed between cases: the one function that commands call."""

from __future__ import annotations

from collections.abc import Sequence

from nxt_twin.diagnose.changed.answer import Changes
from nxt_twin.diagnose.changed.engine import compare
from nxt_twin.diagnose.changed.telling import told
from nxt_twin.diagnose.progress import Progress
from nxt_twin.recording.case import Case


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
    return [told(each) for each in compare(before, afters, tolerance, progress)]
