"""A case made ready: which readings are fitted, which only check a choice, and which are held out for the end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray
from nxt_twin.diagnose.fitting.held_ages import with_ages
from nxt_twin.diagnose.fitting.late_rows import with_lateness
from nxt_twin.diagnose.fitting.leaps import leaps, without_leaps
from nxt_twin.diagnose.fitting.noise import damping_per_s, lag_of, roughness
from nxt_twin.diagnose.fitting.parted import parted
from nxt_twin.diagnose.fitting.simulated import simulated
from nxt_twin.diagnose.fitting.splits import (
    WINDOW_S,
    Split,
    length_s,
    with_blocks_that_check,
    with_windows_held_out,
)
from nxt_twin.diagnose.fitting.target import Target
from nxt_twin.diagnose.fitting.variables import scale_of
from nxt_twin.errors import DiagnosisError
from nxt_twin.physics.base.servo import SERVO
from nxt_twin.physics.goals import follower
from nxt_twin.physics.parameter import Scale
from nxt_twin.physics.plant import Plant, plant_from_config
from nxt_twin.physics.recorded import signals_of
from nxt_twin.physics.signals import Signals, in_session
from nxt_twin.physics.simulate import free_job, with_supply
from nxt_twin.physics.start import Start, driven_before, moving_start, restarts, run_in
from nxt_twin.recording.recording import Recording
from nxt_twin.recording.stalls import stalled_share, stalls, stalls_in_words

_LONGEST_THINNING_S = 0.06  # between readings that are kept
_READINGS_PER_TIME_CONSTANT = 8.0  # of the plant's motion, that are kept
_PHASES = 2  # where few readings are left, a thinned recording is fitted from each of so many first readings
_FEW_READINGS = 2000  # below which a thinned recording is used in several phases
_HALF = 0.5  # of an encoder's step does not matter
_MOST_QUANTA = 3.0  # slow polls leave more than noise off a smooth curve
_FEWEST_READINGS = 40  # to fit, below which a case is refused
_LARGEST_READING = 1e9  # SI: a larger one is no reading


@final
@dataclass(frozen=True)
class HeldOut:
    """A recording, or windows of one, that no fit sees. `counted` marks the samples that are judged."""

    signals: Signals
    start: Start
    counted: BoolArray


@final
@dataclass(frozen=True)
class Problem:
    """The plant and the readings of one diagnosis.

    Attributes:
        name: the case's.
        plant: the baseline as it came.
        scale: torque and speed that are ordinary for it.
        target: readings that a fit sees, each predicted from those before it. They are thinned until the
            plant's time constant leaves them independent. Check readings are marked.
        simulated: the same readings, predicted by windows of simulation.
        held_out: what the final figures are about.
        signals: the recordings of `target`, unthinned.
        window_s: length of the free runs in `held_out`.
        tolerance: the error of a simulation that does not matter, SI.
        stalls: where the host or the link stood still, in words, by recording.
        stalled_share: the largest share of a recording's time that went by so.
        without: ids of effects that no search may try, as if nobody knew them.
        leaning: what speaks beforehand for effects, nats by id, where somebody has watched the motor already.
        by_windows: whether windows of simulation alone set parameters and weigh effects, as single steps are coloured.
        instead_of: names of the recordings that were held out at first, and alone showed what is missing.
        leaps: stamps of readings that leap away and back and were left out, s, by recording.
    """

    name: str
    plant: Plant
    scale: Scale
    target: Target
    simulated: Target
    held_out: tuple[HeldOut, ...]
    signals: tuple[Signals, ...]
    window_s: float
    tolerance: float
    stalls: Mapping[str, str]
    stalled_share: float
    without: frozenset[str] = frozenset()
    leaning: Mapping[str, float] = field(default_factory=dict)
    by_windows: bool = False
    instead_of: tuple[str, ...] = ()
    leaps: Mapping[str, FloatArray] = field(default_factory=dict)

    def everything(self) -> Target:
        """Target and check together: what the last fit uses."""
        return self.target.everything()

    @property
    def objective(self) -> Target:
        """The targets of a fit: each reading predicted one step ahead, and each reading simulated."""
        if not self.by_windows:
            return self.target.beside(self.simulated)
        windows = replace(self.simulated, pull=(1.0,) * len(self.simulated.jobs))
        return self.target.counting_for_nothing().beside(windows)

    @property
    def check(self) -> tuple[BoolArray, ...]:
        """Readings of the target's recordings that only judge a choice of structure."""
        return self.target.check


def problem_of(
    name: str,
    config: Mapping[str, Any],
    recordings: Sequence[Recording],
    holdout: Sequence[Recording],
    port: str | None,
    tolerance: float | None = None,
    *,
    second: bool = False,
) -> Problem:
    """Make a case ready. Without `holdout`, one of each three recordings is held out; of one or two, windows of time.

    `tolerance` is in SI; without one, half a step of the encoder or the roughness of its readings, if that is more.
    With `second`, the second choice of `parted` is held out instead.

    Raises:
        PlantError: the plant's configuration is none, or cannot be driven by these recordings.
        DiagnosisError: the recordings are driven in different ways, are too short, or nothing moves.
    """
    follows = config.get("kind") == SERVO.kind
    made = [*recordings, *holdout]
    every = [signals_of(each, port, follows_goal=follows) for each in made]
    leaping = {one.name: one.time_s[leaps(one)] for one in every}
    read = with_lateness(with_ages(in_session([without_leaps(one) for one in every])))
    kinds = {signals.input_kind for signals in read}
    if len(kinds) > 1:
        raise DiagnosisError(
            f"its recordings are driven by {', '.join(sorted(kinds))}", where=name, mend="split it"
        )
    plant = plant_from_config(follower(config, made, port), read[0].input_kind)
    for signals in read:
        _refuse_no_motion(signals)
    lag_s = lag_of(plant)
    supplied = [with_supply(driven_before(replace(one, lag_s=lag_s)), plant) for one in read]
    fitted, apart = supplied[: len(recordings)], supplied[len(recordings) :]
    if not any(np.nanstd(signals.measured) > max(signals.quantum, 1e-12) for signals in fitted):
        raise DiagnosisError("nothing moves", where=name, mend="record a run in which the motor turns")
    if not apart:
        fitted, apart = parted(fitted, second=second)
    splits, held_out, window_s = _split(fitted, apart)
    target = target_of(plant, fitted, splits)
    _refuse_too_few(name, target, held_out)
    return Problem(
        name=name,
        plant=plant,
        scale=scale_of(plant, fitted),
        target=target,
        simulated=simulated(target, window_s),
        held_out=tuple(held_out),
        signals=tuple(fitted),
        window_s=window_s,
        tolerance=_default_tolerance(fitted) if tolerance is None else tolerance,
        stalls={one.name: said for one in made if (said := stalls_in_words(stalls(one)))},
        stalled_share=max(map(stalled_share, made)),
        leaps={name: times_s for name, times_s in leaping.items() if times_s.size},
    )


def _split(fitted: Sequence[Signals], apart: Sequence[Signals]) -> tuple[list[Split], list[HeldOut], float]:
    """How recordings that are fitted are split, what is held out of them or is recorded `apart`, and its windows, s."""
    if apart:
        whole = [_held_out(each, WINDOW_S, np.ones(each.time_s.size, dtype=bool)) for each in apart]
        return with_blocks_that_check(fitted), whole, WINDOW_S
    splits, window_s = with_windows_held_out(fitted)
    pairs = zip(fitted, splits, strict=True)
    return splits, [_held_out(signals, window_s, split.held_out) for signals, split in pairs], window_s


def _refuse_no_motion(signals: Signals) -> None:
    """Refuse what no simulation could follow."""
    if signals.time_s[-1] <= signals.time_s[0]:
        raise DiagnosisError("its stamps never advance", where=signals.name, mend="record it anew")
    largest = float(np.nanmax(np.abs(signals.measured), initial=0.0))
    if largest > _LARGEST_READING:
        raise DiagnosisError(
            f"reads up to {largest:.0e} in SI units, which no motor does",
            where=signals.name,
            mend="check its unit",
        )


def _refuse_too_few(name: str, target: Target, held_out: Sequence[HeldOut]) -> None:
    """Refuse a case of which some part would be empty, or too small to fit."""
    count = int(sum(w * counted.sum() for w, counted in zip(target.evidence, target.counted, strict=True)))
    if count < _FEWEST_READINGS:
        raise DiagnosisError(
            f"only {count} readings are left to fit, of {_FEWEST_READINGS} at least",
            where=name,
            mend="record for longer",
        )
    checking = sum(int(mask.sum()) for mask in target.checking().seen())
    judged = sum(int((part.counted & ~part.start.at).sum()) for part in held_out)
    if not checking or not judged:
        missing = "check a choice" if not checking else "hold out"
        raise DiagnosisError(f"no readings are left to {missing}", where=name, mend="record for longer")


def _default_tolerance(signals: Sequence[Signals]) -> float:
    quantum = max(one.quantum for one in signals)
    rough = roughness(signals)
    return max(_HALF * quantum, min(rough, _MOST_QUANTA * quantum) if quantum > 0.0 else rough)


def _held_out(signals: Signals, window_s: float, held: BoolArray) -> HeldOut:
    judged = np.isfinite(signals.measured) & held & ~run_in(signals)
    return HeldOut(signals, restarts(signals, window_s), judged)


def target_of(plant: Plant, fitted: Sequence[Signals], splits: Sequence[Split]) -> Target:
    """The readings of `fitted`, thinned to what is independent under `plant`, each recording split as `splits` say."""
    interval_s = _thinning_s(plant)
    dense = all(interval_s > 1.5 * signals.interval_s for signals in fitted)
    phases = _PHASES if dense and sum(map(length_s, fitted)) < _FEW_READINGS * interval_s else 1
    jobs, counted, check = [], [], []
    for signals, split in zip(fitted, splits, strict=True):
        start = moving_start(signals)
        for phase in range(phases):
            rows = _thinned(signals, interval_s, phase * interval_s / phases)
            jobs.append(free_job(signals.part(rows), start.part(rows)))
            counted.append((~split.held_out & ~split.check)[rows])
            check.append((~split.held_out & split.check)[rows])
    size = len(jobs)
    return Target(
        tuple(jobs), tuple(counted), tuple(check), (1.0 / phases,) * size, (None,) * size, (1.0,) * size
    )


def _thinning_s(plant: Plant) -> float:
    """Readings denser than this tell of what is faster than the plant, and would drown what is not."""
    damping = damping_per_s(plant)
    return min(_LONGEST_THINNING_S, 1.0 / (_READINGS_PER_TIME_CONSTANT * max(damping, 1e-9)))


def _thinned(signals: Signals, interval_s: float, delay_s: float) -> IntArray:
    """The first row, and those with a reading at least `interval_s` after the last, the first `delay_s` later."""
    kept = [0]
    due_s = float(signals.time_s[0]) + delay_s + interval_s
    for k in np.flatnonzero(np.isfinite(signals.measured)):
        if signals.time_s[k] >= due_s - 1e-6 * interval_s:
            kept.append(int(k))
            due_s = float(signals.time_s[k]) + interval_s
    return np.array(kept)
