"""A case made ready: which readings are fitted, which only check a choice, and which are held out for the end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np

from nxt_twin.arrays import BoolArray, IntArray
from nxt_twin.diagnose.fitting.fit import Target
from nxt_twin.diagnose.fitting.noise import damping_per_s
from nxt_twin.diagnose.fitting.variables import scale_of
from nxt_twin.errors import DiagnosisError
from nxt_twin.physics.parameter import Scale
from nxt_twin.physics.plant import Plant, plant_from_config
from nxt_twin.physics.recorded import signals_of
from nxt_twin.physics.signals import Signals, in_session
from nxt_twin.physics.simulate import free_job, with_supply
from nxt_twin.physics.start import Start, moving_start, restarts
from nxt_twin.recording.recording import Recording

WINDOW_S = 2.0
"""Length of the free runs on which models are judged; a longer one rewards lucky drift of an integrator."""

_WINDOWS_OF_ONE = 6  # a single recording is cut into at least this many windows, every third held out
_PARTS = 4  # one recording, or block of time, in so many checks a choice of structure instead of being fitted
_LONGEST_THINNING_S = 0.06
_READINGS_PER_TIME_CONSTANT = 8.0
_PHASES = 2  # where few readings are left, a thinned recording is fitted from each of so many first readings
_FEW_READINGS = 2000
_FEWEST_READINGS = 50
_LARGEST_READING = 1e9


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
    """What one diagnosis works on.

    Attributes:
        name: the case's.
        plant: the baseline as it came.
        scale: torque and speed that are ordinary for it.
        target: readings that a fit sees, thinned to what the plant's time constant leaves independent.
        check: readings of the same recordings that only judge a choice of structure.
        held_out: what the final figures are about.
        signals: the recordings of `target`, unthinned.
        window_s: length of the free runs in `held_out`.
    """

    name: str
    plant: Plant
    scale: Scale
    target: Target
    check: tuple[BoolArray, ...]
    held_out: tuple[HeldOut, ...]
    signals: tuple[Signals, ...]
    window_s: float

    def everything(self) -> Target:
        """Target and check together: what the last fit uses."""
        both = tuple(a | b for a, b in zip(self.target.counted, self.check, strict=True))
        return replace(self.target, counted=both)


def problem_of(
    name: str,
    config: Mapping[str, Any],
    recordings: Sequence[Recording],
    holdout: Sequence[Recording],
    port: str | None,
) -> Problem:
    """Make a case ready. Without `holdout`, every third recording is held out; of one or two, windows of time.

    Raises:
        PlantError: the plant's configuration is none, or cannot be driven by these recordings.
        DiagnosisError: the recordings are driven in different ways, are too short, or nothing moves.
    """
    read = in_session([signals_of(recording, port) for recording in [*recordings, *holdout]])
    kinds = {signals.input_kind for signals in read}
    if len(kinds) > 1:
        raise DiagnosisError(
            f"its recordings are driven by {', '.join(sorted(kinds))}", where=name, mend="split it"
        )
    plant = plant_from_config(config, read[0].input_kind)
    supplied = [with_supply(signals, plant) for signals in read]
    fitted, apart = supplied[: len(recordings)], supplied[len(recordings) :]
    for signals in read:
        _refuse_no_motion(signals)
    if not any(np.nanstd(signals.measured) > max(signals.quantum, 1e-12) for signals in fitted):
        raise DiagnosisError("nothing moves", where=name, mend="record a run in which the motor turns")
    if not apart and len(fitted) >= 3:
        apart, fitted = fitted[2::3], [s for i, s in enumerate(fitted) if i % 3 != 2]
    window_s = WINDOW_S
    masks = [np.zeros(s.time_s.size, dtype=bool) for s in fitted]
    held_out = [_whole(signals, window_s) for signals in apart]
    if not apart:
        shortest = min(float(s.time_s[-1] - s.time_s[0]) for s in fitted)
        window_s = min(WINDOW_S, shortest / _WINDOWS_OF_ONE)
        held_out = [_windows(signals, window_s) for signals in fitted]
        masks = [part.counted for part in held_out]
    target, check = _split(plant, fitted, masks)
    count = int(target.evidence * sum(int(counted.sum()) for counted in target.counted))
    if count < _FEWEST_READINGS:
        raise DiagnosisError(
            f"only {count} readings are left to fit, of {_FEWEST_READINGS} at least",
            where=name,
            mend="record for longer",
        )
    return Problem(
        name=name,
        plant=plant,
        scale=scale_of(plant, fitted),
        target=target,
        check=check,
        held_out=tuple(held_out),
        signals=tuple(fitted),
        window_s=window_s,
    )


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


def _whole(signals: Signals, window_s: float) -> HeldOut:
    start = restarts(signals, window_s)
    return HeldOut(signals, start, np.isfinite(signals.measured))


def _windows(signals: Signals, window_s: float) -> HeldOut:
    number = np.floor((signals.time_s - signals.time_s[0]) / window_s).astype(int)
    return HeldOut(signals, restarts(signals, window_s), np.isfinite(signals.measured) & (number % 3 == 2))


def _split(
    plant: Plant, fitted: Sequence[Signals], excluded: Sequence[BoolArray]
) -> tuple[Target, tuple[BoolArray, ...]]:
    interval_s = _thinning_s(plant)
    dense = all(interval_s > 1.5 * signals.interval_s for signals in fitted)
    seconds = sum(float(signals.time_s[-1] - signals.time_s[0]) for signals in fitted)
    phases = _PHASES if dense and seconds < _FEW_READINGS * interval_s else 1
    jobs, counted, check = [], [], []
    for number, (signals, mask) in enumerate(zip(fitted, excluded, strict=True)):
        start = moving_start(signals)
        elapsed_s = signals.time_s - signals.time_s[0]
        block_s = max(0.5, min(2.0, float(elapsed_s[-1]) / 16.0))
        block = np.floor(elapsed_s / block_s).astype(int)
        if len(fitted) >= _PARTS:  # other inputs are a harder check than other moments of the same run
            block[:] = number
        checks = block % _PARTS == _PARTS - 1
        for phase in range(phases):
            rows = _thinned(signals, interval_s, phase * interval_s / phases)
            jobs.append(free_job(signals.part(rows), start.part(rows)))
            counted.append((~mask & ~checks)[rows])
            check.append((~mask & checks)[rows])
    return Target(tuple(jobs), tuple(counted), 1.0 / phases), tuple(check)


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
