"""The answer of a comparison: verdict, changes, errors."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, final

from nxt_twin.diagnose.diagnosis import (
    Estimate,
    Fit,
    FoundEffect,
    HeldOutRun,
    Mismatch,
    Moved,
    Tolerance,
)
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.robot.drive import DifferentialDrive

ChangeVerdict = Literal["unchanged", "changed", "unexplained"]


@final
@dataclass(frozen=True)
class Change:
    """A parameter, or an effect, that differs after.

    Attributes:
        of: the parameter's name, or the effect's id.
        before, after: values in `unit`; of an effect those of its main parameter, null where it did not act.
        std: standard deviation of the difference.
        interval_95: of the value after, given the one before.
        probability: that it differs.
        params: of an effect.
    """

    of: str
    before: float | None
    after: float
    std: float
    unit: str
    interval_95: tuple[float, float]
    probability: float
    params: dict[str, Estimate] = field(default_factory=dict)


@final
@dataclass(frozen=True)
class OtherChange:
    """A change that the recordings do not tell from one that is named.

    Attributes:
        id: the parameter's name, or the effect's id.
        instead_of: the named change in whose place it would stand.
        probability: that it is this one of the two.
        holdout_rmse: error of simulated windows after that no fit saw, with it.
    """

    id: str
    instead_of: str
    probability: float
    holdout_rmse: float


@final
@dataclass(frozen=True, repr=False)
class Changes:
    """What differs on a side after, and how well that accounts for it.

    Attributes:
        name: of the side after.
        before: name of the side before.
        verdict: whether anything differs, and whether few changes say what.
        sentence: in words.
        changes: the likeliest first.
        refit: what both sides share, as it came and as it was fitted.
        effects: those among the changes.
        fit: errors of simulated windows of the side after, which no fit saw. They are given for the plant
            before, for the plant with the changes, and for a plant that shares nothing with the side before.
        tolerance: error that does not matter.
        mismatch: the column that was read, and the equation in which the changes stand.
        notes: what else a reader should know.
        held_out: recordings of the side after, in windows that no fit saw: as measured, as predicted by the
            plant before (`baseline`), and with the changes (`improved`).
        plant: of the side after.
        alternatives: changes that the recordings do not tell from named ones, the likeliest first.
    """

    name: str
    before: str
    verdict: ChangeVerdict
    sentence: str
    changes: tuple[Change, ...]
    refit: dict[str, Moved]
    effects: tuple[FoundEffect, ...]
    fit: Fit
    tolerance: Tolerance
    mismatch: Mismatch
    notes: tuple[str, ...]
    held_out: tuple[HeldOutRun, ...]
    plant: Plant | DifferentialDrive = field(compare=False)
    alternatives: tuple[OtherChange, ...] = ()

    def __repr__(self) -> str:
        """Short: names, verdict and changes."""
        changes = ", ".join(change.of for change in self.changes)
        return f"<Changes {self.before} → {self.name}: {self.verdict}{f' in {changes}' if changes else ''}>"
