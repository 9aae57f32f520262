"""Predictions of the plant before and of the changed plant, for windows after the change that no fit saw."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.changed.joint import JointFit, JointFitter, each_window_rms, window_rms
from nxt_twin.diagnose.changed.sides import Side
from nxt_twin.diagnose.diagnosis import HeldOutRun
from nxt_twin.diagnose.units import Units


@final
@dataclass(frozen=True)
class Predicted:
    """Predictions of the readings after that only check, end to end, SI; arrays have shape (readings,).

    Attributes:
        side: after.
        as_before: by the plant before, as if nothing had changed.
        now: by the plant after.
        everywhere: by the plant after, of all its readings, end to end, shape (all readings,).
    """

    side: Side
    as_before: FloatArray
    now: FloatArray
    everywhere: FloatArray

    @property
    def rms_before(self) -> float:
        """The error of the plant before, SI."""
        return window_rms(self.side, self.as_before)

    def share_beyond(self, limit: float) -> float:
        """The share of all windows in which the plant after errs by more than `limit`, SI."""
        return float(np.mean(each_window_rms(self.side, self.everywhere, "everything") > limit))


def predicted_after(fitter: JointFitter, joint: JointFit) -> Predicted:
    """Both predictions of the side after, from a joint that was fitted to the other readings."""
    model = joint.model
    bare = replace(model, differs=(), effects=(), after=model.plant, added=())
    x = joint.x[None, : len(model.shared)]
    return Predicted(
        fitter.sides[1],
        fitter.run(bare, x, 1, "check")[0],
        fitter.run(model, joint.x[None], 1, "check")[0],
        fitter.run(model, joint.x[None], 1, "everything")[0],
    )


def runs_of(predicted: Predicted, units: Units) -> tuple[HeldOutRun, ...]:
    """One run for each recording of the side after that has windows which were not fitted."""
    side, first, found = predicted.side, 0, []
    for job, mask in zip(side.jobs, side.check, strict=True):
        part = slice(first, first + int(mask.sum()))
        first = part.stop
        if part.stop == part.start:
            continue
        signals, factor = job.signals, units.reading_factor
        measured = signals.measured[mask] * factor
        before, now = predicted.as_before[part] * factor, predicted.now[part] * factor
        found.append(
            HeldOutRun(
                recording=signals.name,
                time_s=(signals.time_s - signals.time_s[0])[mask],
                command=signals.command_at_samples()[mask] * units.command_factor,
                command_label=units.command,
                measured=measured,
                baseline=before,
                improved=now,
                stale=np.zeros(measured.size),
                baseline_rmse=_rms(before - measured),
                improved_rmse=_rms(now - measured),
            )
        )
    return tuple(found)


def _rms(error: FloatArray) -> float:
    return float(np.sqrt(np.mean(error**2)))
