"""A diagnosis: one immutable value that report, JSON and twin read."""

from __future__ import annotations

from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING, Final, Literal, final

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.effect import Equation
from nxt_twin.physics.plant import Plant
from nxt_twin.recording.program import MotorProgram
from nxt_twin.recording.robot_path import RobotPath

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_PICTURES: Final = "nxt_twin.view.figures"
"""What draws a diagnosis, named rather than imported: this room knows nothing of those above it."""

NORMAL_95: Final = 1.959964
"""Standard deviations from a value to either end of its 95 % interval."""

Verdict = Literal["adequate", "explained", "unexplained"]
Source = Literal["actuator", "battery", "transmission", "encoder", "clock_or_link"]


@final
@dataclass(frozen=True)
class Ratio:
    """A parameter relative to another one (`of`), which needs no anchor, in `unit`."""

    value: float
    std: float
    unit: str
    of: str


@final
@dataclass(frozen=True)
class Estimate:
    """A parameter's value with its standard deviation, in `unit`.

    Attributes:
        interval_95: within which it lies 95 times of 100.
        rests_on: names of the anchors without which the recordings would only give `ratio`; empty for what
            they fix by themselves.
    """

    value: float
    std: float
    unit: str
    interval_95: tuple[float, float] | None = None
    rests_on: tuple[str, ...] = ()
    ratio: Ratio | None = None

    @property
    def is_loose(self) -> bool:
        """Whether the 95 % interval is wider than the value, and that of the ratio is, where the recordings fix one.

        The ratio leaves the anchors' doubt out. Where a payload makes the motor's own inertia open, the value is surer.
        """
        both = (self,) if self.ratio is None else (self, self.ratio)
        return all(2.0 * NORMAL_95 * one.std > abs(one.value) for one in both)


@final
@dataclass(frozen=True)
class Moved:
    """A baseline parameter before and after the re-fit, in `unit`; the rest as in `Estimate`."""

    before: float
    after: float
    std: float
    unit: str
    interval_95: tuple[float, float] | None = None
    rests_on: tuple[str, ...] = ()
    ratio: Ratio | None = None


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
class SourceFinding:
    """What freeing an extra variance in one equation gains: `strength` in nats, and how often chance does as well."""

    source: Source
    equation: Equation
    strength: float
    p_value: float


@final
@dataclass(frozen=True)
class Onset:
    """A moment, between `low_s` and `high_s`, at which `what` sets in or changes; `strength` in nats.

    `what` is the id of an effect that was not there before, or the name of a parameter that is another since.
    """

    what: str
    recording: str
    time_s: float
    low_s: float
    high_s: float
    strength: float
    p_value: float


@final
@dataclass(frozen=True)
class Mismatch:
    """Where the baseline fails: channel, time, regime, equation. `equation` is None where nothing fails.

    Attributes:
        channel: the column that was read.
        when: stretches of time in which it fails.
        regimes: in which the mismatch gathers.
        equation: the one that fails.
        source: where that equation lives: in the actuator, the battery, the transmission, the encoder or the clock.
        sources: how strongly the readings ask for noise in each, whatever is known of effects.
        onsets: moments from which on the plant is another.
    """

    channel: str
    when: tuple[Spell, ...]
    regimes: tuple[RegimeFinding, ...]
    equation: Equation | None
    source: Source | None = None
    sources: tuple[SourceFinding, ...] = ()
    onsets: tuple[Onset, ...] = ()


@final
@dataclass(frozen=True)
class Confusion:
    """Another effect that these recordings cannot tell from the named one."""

    id: str
    why: str


@final
@dataclass(frozen=True)
class FoundEffect:
    """An effect that the data call for, with its parameters and its doubt; `motor` says which of a robot's has it."""

    id: str
    name: str
    equation: str
    params: dict[str, Estimate]
    probability: float
    confusable_with: tuple[Confusion, ...]
    motor: Literal["left", "right"] | None = None

    @property
    def key(self) -> str:
        """Its id, behind the motor that has it: ``left_motor.voltage_drop``."""
        return f"{self.motor}_motor.{self.id}" if self.motor else self.id


@final
@dataclass(frozen=True)
class Alternative:
    """A structure that was tried and came second; `holdout_rmse` in the unit of `Fit`."""

    id: str
    probability: float
    holdout_rmse: float


@final
@dataclass(frozen=True)
class Horizon:
    """Errors after so long from a measured start: model as given, re-fitted, improved, and what is within reach.

    Attributes:
        seconds: how long; None for whole recordings.
        metres: how far, where the horizon is a distance; `seconds` is then what it took on average.
    """

    seconds: float | None
    given: float
    baseline: float
    improved: float
    floor: float
    metres: float | None = None


@final
@dataclass(frozen=True)
class Fit:
    """Error on data that was not fitted: re-fitted baseline, improved plant, and what noise alone would give.

    Attributes:
        horizons: likewise for several lengths, in the unit of `Fit`.
    """

    metric: str
    unit: str
    baseline: float
    improved: float
    floor: float
    horizons: tuple[Horizon, ...] = ()


@final
@dataclass(frozen=True)
class Tolerance:
    """The error that does not matter, and what the improved plant leaves, both in `unit`."""

    value: float
    unit: str
    remaining: float


@final
@dataclass(frozen=True)
class NextExperiment:
    """What to record next, and why.

    Attributes:
        expected_nats: evidence to expect between the two rivals in `seconds`, None where none was worked out.
        program: the input for a motor that a brick can run, None for other plants.
        path: for a robot to drive, None for other plants.
    """

    why: str
    input: str
    expected_nats: float | None = None
    seconds: float | None = None
    program: MotorProgram | None = None
    path: RobotPath | None = None


@final
@dataclass(frozen=True)
class DetectableSize:
    """The smallest size of an effect that these recordings would have shown nine times of ten.

    Attributes:
        parameter: whose size it is; of two that replace a plain term, their difference.
        size: in `unit`; None where no ordinary size would have shown.
        seen_above: larger is easier to see; a stiffness or a limit shows the better the smaller it is.
    """

    id: str
    name: str
    parameter: str
    size: float | None
    unit: str
    seen_above: bool


@final
@dataclass(frozen=True)
class Excitation:
    """Whether the recordings could have shown what may be missing.

    Attributes:
        enough: they could.
        lacks: what their inputs never do.
        unseen: ids of effects that an ordinary size would not have given away.
    """

    enough: bool
    lacks: tuple[str, ...]
    unseen: tuple[str, ...]


@final
@dataclass(frozen=True)
class FalseAlarmRate:
    """How often noise alone would have been called missing physics: of synthetic clean recordings like these."""

    rate: float
    upper_95: float
    of: int


@final
@dataclass(frozen=True)
class Nearest:
    """The known effect that comes nearest to what is left, and why it was not accepted."""

    id: str
    name: str
    why: str


@final
@dataclass(frozen=True)
class DrivenPath:
    """A robot's way over the floor, m: places of shape (samples, 2), as measured and as three models say."""

    measured: FloatArray
    given: FloatArray
    baseline: FloatArray
    improved: FloatArray


@final
@dataclass(frozen=True)
class HeldOutRun:
    """One recording (or block of one) that was not fitted: what was measured and what the two models say.

    All arrays have shape (samples,). `measured`, `baseline`, `improved` are in the unit of `Fit`;
    `stale` marks samples judged to be a fault of the transport, left out of the errors. `path` is a robot's, whose
    `measured` is zero and whose models' values are distances from the measured place.
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
    path: DrivenPath | None = None


@final
@dataclass(frozen=True)
class Leftover:
    """The unknown torque (or force) that the smoother assigns to each sample, and what it goes with.

    Arrays have shape (samples,), fitted recordings one after another; `before` is left by the re-fitted
    baseline and `after` by the improved plant, in `unit`. `drive` is the motor's current, or the force that drives.
    """

    unit: str
    speed_unit: str
    position_unit: str
    time_s: FloatArray
    speed: FloatArray
    position: FloatArray
    before: FloatArray
    after: FloatArray
    drive: FloatArray | None = None
    drive_label: str = ""


@final
@dataclass(frozen=True, repr=False)
class Diagnosis:
    """The whole answer for one case.

    Attributes:
        name: the case's or recording's name.
        verdict: `adequate`, `explained` or `unexplained` (docs/formats.md#diagnosis-json).
        sentence: what is wrong, in one sentence for a person.
        notes: plain remarks for that person: anchors, runs that stay bad and why, faults of the transport.
        held_out: the runs on which `fit` is reported.
        leftover: the unknown torque before and after, or None where it was not estimated.
        detectable: the smallest size of each effect that is not in the plant that would have been seen.
        excitation: what the recordings could not have shown, or None where it was not asked.
        false_alarm_rate: of the whole search on recordings like these.
        nearest: to what is left, where something is.
        plant: the improved model, where the case is about a plant and it was asked for.
        tolerance: the error that does not matter, where one was asked about.
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
    detectable: tuple[DetectableSize, ...] = ()
    excitation: Excitation | None = None
    false_alarm_rate: FalseAlarmRate | None = None
    nearest: Nearest | None = None
    tolerance: Tolerance | None = None
    plant: Plant | None = field(default=None, compare=False)

    def __repr__(self) -> str:
        """Short: name, verdict and effects."""
        effects = ", ".join(effect.id for effect in self.effects)
        return f"<Diagnosis {self.name}: {self.verdict}{f' by {effects}' if effects else ''}>"

    def plot(self, run: int = 0) -> Figure:
        """Draw a held-out run: measured and predicted, the command, and the errors over time.

        Args:
            run: which one; 0 is the run that tells most.

        Returns:
            A Matplotlib figure.
        """
        draw = getattr(import_module(_PICTURES), "diagnosis_figure")  # noqa: B009 - mypy knows no such module
        figure: Figure = draw(self, run)
        return figure
