"""When commands act, and when readings were taken."""

from __future__ import annotations

import math

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.parameter import NUMBER, Parameter


def _delay(command_delay: float) -> float:
    return command_delay


COMMAND_DELAY = Effect(
    id="command_delay",
    name="command delay",
    equation="u(t) = command(t - d)",
    equation_of="timing",
    shows=("after_command",),
    parameters=(Parameter("delay_s", "command_delay", "s", NUMBER, (0.01, 0.04, 0.1), 0.0, 0.5),),
    terms={"delay": _delay},
    confusable_with={
        "inductance": "below two samples nothing tells them apart; poll faster",
        "backlash": "a delay acts on every command, play only where the torque changes sign",
    },
)


def _stale_density(
    reading: float, predicted: float, last_reading: float, reading_std: float, stale_fraction: float
) -> float:
    low = min(last_reading, predicted)
    high = max(last_reading, predicted)
    width = high - low
    if width < 0.1 * reading_std:
        gauss = math.exp(-0.5 * ((reading - predicted) / reading_std) ** 2)
        return stale_fraction * gauss / (reading_std * math.sqrt(2.0 * math.pi))
    scale = reading_std * math.sqrt(2.0)
    inside = math.erf((reading - low) / scale) - math.erf((reading - high) / scale)
    return stale_fraction * 0.5 * inside / width


STALE_SAMPLES = Effect(
    id="stale_samples",
    name="stale samples",
    equation="with probability p a reading was taken at any time since the last one, and stamped late",
    equation_of="timing",
    shows=("after_gap",),
    parameters=(Parameter("stale_fraction", "stale_fraction", "1", NUMBER, (0.02,), 1e-4, 0.5, frozen=True),),
    terms={"outlier": _stale_density},
    fault=True,
)
