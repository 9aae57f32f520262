"""A concealed case in memory: what the solver gets, and what it must not see."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.recording.recording import Recording

SEAL_FILE: Final = "answer.sha256"

NOMINAL: Final[Mapping[str, float]] = {
    "resistance_ohm": 7.6,
    "inductance_h": 4.88e-3,
    "torque_constant_nm_per_a": 0.4908,
    "back_emf_v_s_per_rad": 0.4908,
    "coulomb_friction_nm": 8.45e-3,
    "viscous_friction_nm_s_per_rad": 1.92e-3,
    "inertia_kg_m2": 1.2e-3,
    "supply_v": 8.0,
}
"""The baseline of docs/formats.md#plant-files, which every case shows its solver whatever the true motor is."""


@final
@dataclass(frozen=True)
class ConcealedCase:
    """One case of the benchmark.

    Attributes:
        name: of the case's folder and of its answer.
        content: what `case.yaml` holds (docs/formats.md#cases).
        recordings: in the order of `content`, held-out ones last.
        answer: what `<name>.json` of the answers holds: effects with their true parameters, the true base
            parameters, and the true angle at each stamp.
        sidecar: what stands beside each recording; nothing where the defaults hold.
    """

    name: str
    content: Mapping[str, Any]
    recordings: tuple[Recording, ...]
    answer: Mapping[str, Any]
    sidecar: Mapping[str, Any] = field(default_factory=dict)


def rms(values: FloatArray) -> float:
    """The root mean square to four digits after the point, as answers state it."""
    return round(float(np.sqrt(np.mean(values**2))), 4)
