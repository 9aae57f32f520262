"""A button's thresholds from press and release cycles: every threshold and scatter is weighed.

A press only shows between which two steps the switch closed. With most of the paper's sensors the scatter is smaller
than a step. Then all thresholds in between are equally likely, and there is no likeliest one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from scipy.special import logsumexp

from nxt_twin.arrays import FloatArray
from nxt_twin.experiment.errors import ExperimentError
from nxt_twin.experiment.identified import Identified
from nxt_twin.experiment.plan import TouchCycles
from nxt_twin.experiment.posterior import weighed
from nxt_twin.experiment.sweep import sweep_of
from nxt_twin.recording.recording import Recording
from nxt_twin.sensors import touch
from nxt_twin.sensors.intervals import log_interval_probability

_THRESHOLDS: Final = 400
_SCATTERS: Final = 60
_LEAST_SCATTER: Final = 0.03
_MOST_SCATTER: Final = 3.0
"""Scatter that is tried, in steps of the push; evenly by its logarithm."""


def identified_from(experiment: TouchCycles, recordings: Sequence[Recording]) -> Identified:
    """Thresholds and scatter from one recording a cycle.

    Raises:
        ExperimentError: the button never both closed and opened.
    """
    column = sweep_of(experiment).column
    low, high, closes = (np.concatenate(parts) for parts in _strokes(experiment, recordings, column))
    presses, releases = closes > 0.5, closes < 0.5
    if not (presses.any() and releases.any()):
        mend = "press it further and let it go all the way"
        raise ExperimentError("the button never both closed and opened", where="touch cycles", mend=mend)
    step = experiment.push.step
    spread = max(float(np.ptp(0.5 * (low + high)[part])) for part in (presses, releases))
    scatter = np.geomspace(_LEAST_SCATTER * step, _MOST_SCATTER * (step + spread), _SCATTERS)
    press, press_weight = _weights(low[presses], high[presses], scatter)
    release, release_weight = _weights(low[releases], high[releases], scatter)
    each = logsumexp(press_weight, axis=1), logsumexp(release_weight, axis=1)
    suffix, unit, noise = (
        ("force_g", "g", "force_noise_g")
        if experiment.axis == "force_g"
        else ("travel_mm", "mm", "travel_noise_mm")
    )
    closing = weighed(f"press_{suffix}", press, logsumexp(press_weight + each[1][:, None], axis=0), unit)
    opening = weighed(
        f"release_{suffix}", release, logsumexp(release_weight + each[0][:, None], axis=0), unit
    )
    scattering = weighed(noise, scatter, each[0] + each[1], unit)
    parameters = replace(
        touch.TouchParameters(),
        **{
            f"switch_{suffix}": 0.5 * (closing.value + opening.value),
            **{value.name: value.value for value in (closing, opening, scattering)},
        },
    )
    note = f"It closes {closing.value - opening.value:.3g} {unit} above where it opens."
    values = (closing, opening, scattering)
    return Identified(experiment.kind, values, (), (note,), parameters.to_config())


def _strokes(
    experiment: TouchCycles, recordings: Sequence[Recording], column: str
) -> tuple[list[FloatArray], list[FloatArray], list[FloatArray]]:
    """Between which pushes each switching happened, and whether it was a closing."""
    lows, highs, closings = [], [], []
    for recording in recordings:
        strokes = touch.strokes_of(recording.columns[column], recording.columns[f"rig_{experiment.axis}"])
        whole = np.isfinite(strokes.low) & np.isfinite(strokes.high) & (strokes.low < strokes.high)
        lows.append(strokes.low[whole])
        highs.append(strokes.high[whole])
        closings.append(strokes.closes[whole])
    return lows, highs, closings


def _weights(low: FloatArray, high: FloatArray, scatter: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Thresholds that are tried, and how likely each makes the strokes with each scatter, (scatters, thresholds)."""
    width = float(np.median(high - low))
    tried = np.linspace(low.min() - 2.0 * width, high.max() + 2.0 * width, _THRESHOLDS)
    chance = np.zeros((scatter.size, tried.size))
    for a, b in zip(low, high, strict=True):
        lower = (a - tried[None]) / scatter[:, None]
        upper = (b - tried[None]) / scatter[:, None]
        chance += log_interval_probability(lower, upper)
    return tried, chance
