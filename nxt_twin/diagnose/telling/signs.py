"""Recordings whose commands may have lost their sign: then no model of a motor can follow them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from nxt_twin.diagnose.telling.words import listed
from nxt_twin.physics.signals import Signals
from nxt_twin.recording.recording import GOALS
from nxt_twin.recording.unsigned import lost_sign


def lost_signs(recordings: Sequence[Signals]) -> tuple[str, ...]:
    """A sentence on the recordings in which a motor runs both ways under commands of one sign, if there are any."""
    doubtful = [signals.name for signals in recordings if _is_doubtful(signals)]
    if not doubtful:
        return ()
    return (
        f"In {listed(doubtful)} the motor runs both ways while commands of one sign drive it. Check whether the logger "
        "dropped their sign; `sign` in a mapping tells it.",
    )


def _is_doubtful(signals: Signals) -> bool:
    """Goals have no sign to lose. Of readings that are speeds, their sum is the way."""
    if signals.input_kind in GOALS:
        return False
    way = np.nancumsum(signals.measured) if signals.is_speed else signals.measured
    return lost_sign(signals.command_at_samples(), way)
