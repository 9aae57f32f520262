"""The paper's tables, and the numbers of its text, as printed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.sensors import touch_tables


def _array(*values: float) -> FloatArray:
    array = np.array(values)
    array.flags.writeable = False
    return array


SPEED_RPM: Final = _array(0, 66, 115, 155, 195, 233, 265)
SPEED_RAD_PER_S: Final = _array(0, 6.91, 12.04, 16.23, 20.42, 24.39, 27.75)
EMF_V: Final = _array(0, 3.4, 6.0, 7.9, 9.8, 11.9, 13.85)
EMF_PER_SPEED: Final = _array(0.491, 0.498, 0.487, 0.479, 0.487, 0.499)
"""Table I; the last column has no entry for rest. V, V and V·s/rad."""

KS: Final = 0.4908
RESISTANCE_OHM: Final = 7.6
LINE_SLOPE: Final = 1.9248
LINE_OFFSET: Final = 0.2519
"""Equation 5: ω = 1.9248 v - 0.2519, ω in rad/s and v in V."""

STATIC_FRICTION_NM: Final = 3.558e-4
VISCOUS_FRICTION_NM_S_PER_RAD: Final = 1.92e-3


@final
@dataclass(frozen=True)
class TouchTable:
    """Eight sensors, eight repetitions each, at one state change.

    Attributes:
        number: the table's, in Roman numerals.
        unit: g or mm.
        pressing: from off to on; if not, from on to off.
        samples: shape (8 sensors, 8 repetitions).
        means: printed beside them, where they are.
        deviations: printed beside them, where they are.
    """

    number: str
    unit: str
    pressing: bool
    samples: FloatArray
    means: FloatArray | None = None
    deviations: FloatArray | None = None


FORCE_ON: Final = TouchTable(
    number="III",
    unit="g",
    pressing=True,
    samples=touch_tables.PRESS_FORCE_G,
    means=_array(57, 62.6, 71, 66.9, 62.3, 71, 49.6, 52.1),
    deviations=_array(0, 0.38, 0, 0.33, 0.43, 0, 0.48, 0.33),
)
FORCE_OFF: Final = TouchTable(
    number="IV",
    unit="g",
    pressing=False,
    samples=touch_tables.RELEASE_FORCE_G,
    means=_array(53, 60, 67.1, 66, 57.9, 67.1, 48.8, 52),
    deviations=_array(0, 0, 0.11, 0, 0.11, 0.11, 0.44, 0),
)
TRAVEL_ON: Final = TouchTable(
    number="V",
    unit="mm",
    pressing=True,
    samples=touch_tables.PRESS_TRAVEL_MM,
)
TRAVEL_OFF: Final = TouchTable(
    number="VI",
    unit="mm",
    pressing=False,
    samples=touch_tables.RELEASE_TRAVEL_MM,
)

TRAVEL_VARYING: Final = {"V": 8, "VI": 6}
"""The text after Table IV: the only sensor of each table whose travel varies."""

ULTRASONIC_SLOPE: Final = 1.0055
ULTRASONIC_OFFSET: Final = 0.013
ULTRASONIC_LINE_MM: Final = (250.0, 1500.0)
BEAM_DISTANCES_MM: Final = tuple(range(138, 1539, 100))
BEAM_BEST: Final = (438.0, 55.0)
"""Distance, mm, at which echoes come back from the widest angle, and that angle, deg."""
