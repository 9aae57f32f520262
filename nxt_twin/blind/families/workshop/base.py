"""By how much this family's plain motors differ from a textbook's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.blind.families.numbers import Numbers


@final
@dataclass(frozen=True)
class Flaws:
    """Mild deviations that every motor of this family has; ratios unless a unit is named.

    Attributes:
        lean: of Coulomb friction, forward against reverse.
        thaw: by which friction falls as the grease warms.
        thaw_time_s: of that.
        load: friction for each unit of torque carried.
        fade_per_a: fall of the torque constant with current.
        ripple: of the torque constant, by commutation.
        ripple_cycles: a turn of the hub.
        mesh: torque ripple of the gear train, in units of Coulomb friction.
        mesh_cycles: a turn of the hub.
        tired_ohm: resistance of the battery that builds up under load and recovers.
        recovery_s: of that.
    """

    lean: float
    thaw: float
    thaw_time_s: float
    load: float
    fade_per_a: float
    ripple: float
    ripple_cycles: float
    mesh: float
    mesh_cycles: float
    tired_ohm: float
    recovery_s: float


def draw_flaws(motor: Numbers) -> Flaws:
    """The flaws that belong to a motor's seed."""
    rng = np.random.default_rng(int(motor.seed))
    return Flaws(
        lean=float(rng.uniform(-0.025, 0.025)),
        thaw=float(rng.uniform(0.015, 0.035)),
        thaw_time_s=float(rng.uniform(8.0, 25.0)),
        load=float(rng.uniform(0.001, 0.005)),
        fade_per_a=float(rng.uniform(0.003, 0.008)),
        ripple=float(rng.uniform(0.01, 0.03)),
        ripple_cycles=float(rng.choice((144.0, 240.0, 288.0))),
        mesh=float(rng.uniform(0.02, 0.06)),
        mesh_cycles=float(rng.choice((20.0, 24.0, 36.0, 48.0))),
        tired_ohm=motor.resistance_ohm * float(rng.uniform(0.002, 0.005)),
        recovery_s=float(rng.uniform(0.8, 3.0)),
    )
