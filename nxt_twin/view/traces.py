"""A held-out run as the curves that are drawn of it: what was measured, and what each model says."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np
from matplotlib.axes import Axes

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.diagnosis import Diagnosis, HeldOutRun, Spell
from nxt_twin.view import palette
from nxt_twin.view.thinning import envelope, gaps, some, without_infinities
from nxt_twin.view.wording import improves, quantity

_MOST_MARKS = 120
_MOST_SHADED = 0.6  # of a run


@final
@dataclass(frozen=True)
class RunPicture:
    """One held-out run and what is said of it.

    Attributes:
        spells: the stretches of this run in which the baseline fails, strongest first.
        improves: whether there is an improved model to draw beside the baseline.
        floor: the error that noise alone would give, in `unit`.
        names: of the baseline, the improved model and the floor.
    """

    run: HeldOutRun
    quantity: str
    unit: str
    spells: tuple[Spell, ...]
    improves: bool
    floor: float
    names: tuple[str, str, str] = ("baseline", "improved", "noise alone, all runs")

    @property
    def shaded(self) -> tuple[Spell, ...]:
        """The spells to shade: none where they cover most of the run, since then they tell nothing apart."""
        start_s, end_s = float(self.run.time_s[0]), float(self.run.time_s[-1])
        lengths_s = [min(spell.end_s, end_s) - max(spell.start_s, start_s) for spell in self.spells]
        return self.spells if sum(lengths_s) <= _MOST_SHADED * (end_s - start_s) else ()


@final
@dataclass(frozen=True)
class ModelTrace:
    """What one model says of a run, and how far off it is where the measurement is to be trusted."""

    name: str
    colour: str
    values: FloatArray
    error: FloatArray
    rmse: float


def picture_of(diagnosis: Diagnosis, run: HeldOutRun) -> RunPicture:
    """Gather what the picture of one held-out run shows."""
    start_s, end_s = run.time_s[0], run.time_s[-1]
    spells = [
        spell
        for spell in diagnosis.mismatch.when
        if spell.recording == run.recording and spell.end_s > start_s and spell.start_s < end_s
    ]
    spells.sort(key=lambda spell: -spell.strength)
    return RunPicture(
        run=with_gaps(run),
        quantity=quantity(diagnosis.mismatch.channel),
        unit=diagnosis.fit.unit,
        spells=tuple(spells),
        improves=improves(diagnosis),
        floor=diagnosis.fit.floor,
    )


def with_gaps(run: HeldOutRun) -> HeldOutRun:
    """The run with an empty sample in each stretch that was not held out, so that no curve is drawn across it."""
    before = gaps(run.time_s)
    if not before.size or run.path is not None:
        return run
    middle_s = (run.time_s[before] + run.time_s[before + 1]) / 2.0
    emptied: dict[str, Any] = {
        name: np.insert(getattr(run, name), before + 1, np.nan)
        for name in ("command", "measured", "baseline", "improved", "stale")
    }
    return replace(run, time_s=np.insert(run.time_s, before + 1, middle_s), **emptied)


def traces_of(picture: RunPicture) -> list[ModelTrace]:
    """The re-fitted baseline and, where there is one, the improved model."""
    run = picture.run
    measured = trusted(run)
    baseline = without_infinities(run.baseline)
    traces = [
        ModelTrace(picture.names[0], palette.BASELINE, baseline, baseline - measured, run.baseline_rmse)
    ]
    if picture.improves:
        improved = without_infinities(run.improved)
        traces.append(
            ModelTrace(picture.names[1], palette.IMPROVED, improved, improved - measured, run.improved_rmse)
        )
    return traces


def trusted(run: HeldOutRun) -> FloatArray:
    """The measured values, NaN where they are stale or missing."""
    return np.where(run.stale > 0.5, np.nan, without_infinities(run.measured))


def stale_samples(run: HeldOutRun) -> BoolArray:
    """Which samples hold a reading that is judged stale."""
    return (run.stale > 0.5) & np.isfinite(run.measured)


def ordinate_bounds(
    measured: FloatArray, traces: list[ModelTrace], *, reach: float = 0.6
) -> tuple[float, float]:
    """Ordinate limits that show the measurement whole, and of a run-away prediction `reach` times as much."""
    low, high = float(np.nanmin(measured)), float(np.nanmax(measured))
    reach = reach * (high - low) or np.inf
    lowest = min(float(np.nanmin(trace.values, initial=low)) for trace in traces)
    highest = max(float(np.nanmax(trace.values, initial=high)) for trace in traces)
    return widened(max(lowest, low - reach), min(highest, high + reach))


def widened(low: float, high: float) -> tuple[float, float]:
    """The limits with some air around them, also where they are equal."""
    margin = 0.07 * (high - low) or max(abs(low), 1.0) * 1e-3
    return low - margin, high + margin


def draw_measured(
    axes: Axes, run: HeldOutRun, part: slice, factor: float, columns: int, *, dots: bool
) -> None:
    """Draw what was measured, as a line or as dots, and the stale samples beside it as crosses."""
    time_s, stale = run.time_s[part], stale_samples(run)[part]
    measured = factor * without_infinities(run.measured[part])
    style = {"marker": "o", "markersize": 3.4, "linestyle": "none"} if dots else {"linewidth": 2.8}
    axes.plot(*envelope(time_s[~stale], measured[~stale], columns), color=palette.MEASURED, **style)
    marked = some(np.flatnonzero(stale), _MOST_MARKS)
    axes.plot(
        time_s[marked], measured[marked], linestyle="none", marker="x", markersize=4,
        markeredgewidth=1.1, color=palette.STALE, zorder=4,
    )  # fmt: skip
