"""Remarks on moments that each recording has for itself: when something set in, and where a clock stood."""

from __future__ import annotations

import math

import numpy as np

from nxt_twin.diagnose.fitting.own_moments import recordings_of
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.telling.words import listed
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.start import RUN_IN_S

_ONSET = "onset_s"


def own_moments(problem: Problem, plant: Plant) -> tuple[str, ...]:
    """A remark for each effect of `plant` that set in anew in each recording, and one for a clock that wandered so."""
    recordings = recordings_of(problem)
    anew = [
        f"The {effect.name} set in anew in each recording: "
        f"{listed([_when(one, plant.values[Slot(effect.id, onset.symbol)]) for one in recordings])}. "
        "These moments are read from each recording, from one that is held out as well. The plant has their median, "
        "from the first reading of a recording on."
        for effect in plant.effects
        for onset in effect.parameters
        if onset.name == _ONSET and math.isfinite(recordings[0].sets_in_s)
    ]
    wanders = any("pace" in effect.terms for effect in plant.effects)
    if wanders and any(one.clock_s != 0.0 for one in recordings):
        anew.append(
            "The wander of the clock stood elsewhere as each recording began. That is read from each recording, from "
            "one that is held out as well."
        )
    return tuple(anew)


def _when(signals: Signals, onset_s: float) -> str:
    """When it set in, in words; too near an end for anything to tell it, it was there all the time, or never."""
    own_s = onset_s - signals.session_s
    if own_s <= RUN_IN_S:
        return f"from the start of {signals.name}"
    if own_s >= float(np.ptp(signals.time_s)) - RUN_IN_S:
        return f"never in {signals.name}"
    return f"at {own_s:.3g} s of {signals.name}"
