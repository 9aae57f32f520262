"""What a diagnosis says: one immutable value that report, JSON and twin read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, final

from nxt_twin.recording.recording import FloatArray

Verdict = Literal["adequate", "explained", "unexplained"]
Equation = Literal["torque_balance", "electrical", "kinematic", "measurement", "timing"]


@final
@dataclass(frozen=True)
class Estimate:
    """A parameter's value with its standard deviation, in `unit`."""

    value: float
    std: float
    unit: str


@final
@dataclass(frozen=True)
class Moved:
    """A baseline parameter before and after the re-fit, in `unit`."""

    before: float
    after: float
    std: float
    unit: str


@final
@dataclass(frozen=True)
class Spell:
    """A stretch of time in which a recording departs from the baseline; `strength` is in sigmas."""

    recording: str
    start_s: float
    end_s: float
    strength: float


@final
@dataclass(frozen=True)
class RegimeFinding:
    """How strongly the mismatch gathers in one regime (low speed, reversal, …)."""

    regime: str
    strength: float
    p_value: float


@final
@dataclass(frozen=True)
class Mismatch:
    """Where the baseline fails: channel, time, regime, equation. `equation` is None where nothing fails."""

    channel: str
    when: tuple[Spell, ...]
    regimes: tuple[RegimeFinding, ...]
    equation: Equation | None


@final
@dataclass(frozen=True)
class Confusion:
    """Another effect that these recordings cannot tell from the named one."""

    id: str
    why: str


@final
@dataclass(frozen=True)
class FoundEffect:
    """An effect that the data call for, with its parameters and its doubt."""

    id: str
    name: str
    equation: str
    params: dict[str, Estimate]
    probability: float
    confusable_with: tuple[Confusion, ...]


@final
@dataclass(frozen=True)
class Alternative:
    """A structure that was tried and came second; `holdout_rmse` in the unit of `Fit`."""

    id: str
    probability: float
    holdout_rmse: float


@final
@dataclass(frozen=True)
class Fit:
    """Error on data that was not fitted: re-fitted baseline, improved plant, and what noise alone would give."""

    metric: str
    unit: str
    baseline: float
    improved: float
    floor: float


@final
@dataclass(frozen=True)
class NextExperiment:
    """What to record next, and why."""

    why: str
    input: str


@final
@dataclass(frozen=True)
class HeldOutRun:
    """One recording (or block of one) that was not fitted: what was measured and what the two models say.

    All arrays have shape (samples,). `measured`, `baseline`, `improved` are in the unit of `Fit`;
    `stale` marks samples judged to be a fault of the transport, left out of the errors.
    """

    recording: str
    time_s: FloatArray
    command: FloatArray
    command_label: str
    measured: FloatArray
    baseline: FloatArray
    improved: FloatArray
    stale: FloatArray
    baseline_rmse: float
    improved_rmse: float


@final
@dataclass(frozen=True)
class Leftover:
    """The unknown torque (or force) that the smoother assigns to each sample, and what it goes with.

    Arrays have shape (samples,), fitted recordings one after another; `before` is left by the re-fitted
    baseline and `after` by the improved plant, in `unit`.
    """

    unit: str
    speed_unit: str
    position_unit: str
    time_s: FloatArray
    speed: FloatArray
    position: FloatArray
    before: FloatArray
    after: FloatArray


@final
@dataclass(frozen=True)
class Diagnosis:
    """The whole answer for one case.

    Attributes:
        name: the case's or recording's name.
        verdict: `adequate`, `explained` or `unexplained` (contract 4).
        sentence: what is wrong, in one sentence for a person.
        notes: plain remarks for that person: anchors, runs that stay bad and why, faults of the transport.
        held_out: the runs on which `fit` is reported.
        leftover: the unknown torque before and after, or None where it was not estimated.
    """

    name: str
    verdict: Verdict
    sentence: str
    refit: dict[str, Moved]
    mismatch: Mismatch
    effects: tuple[FoundEffect, ...]
    alternatives: tuple[Alternative, ...]
    fit: Fit
    next_experiment: NextExperiment | None
    notes: tuple[str, ...]
    held_out: tuple[HeldOutRun, ...]
    leftover: Leftover | None
