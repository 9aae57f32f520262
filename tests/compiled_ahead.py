"""Compiles what the workers of a test run share, once and before they start: each would compile it all for itself.

Run with the name of a half; two processes that do one half each keep two cores at work.
"""

from __future__ import annotations

import gc
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent / "physics"))
from physics_samples import NXT, commanded, disc, free_job, moving, nxt

from nxt_twin.blind.families.family import Order
from nxt_twin.blind.families.table import FAMILIES
from nxt_twin.blind.sets import CasePlan
from nxt_twin.physics.abreast import FEWEST
from nxt_twin.physics.jointed import JointDrives
from nxt_twin.physics.plant import Plant, plant_from_config
from nxt_twin.physics.simulate import Simulator
from nxt_twin.physics.stepper import Stepper
from nxt_twin.twin.rehearsal import rehearse

MOTOR, BODY = nxt(), disc()
CART = plant_from_config({"kind": "rigid_body", "inertia": 1.0}, "force_n")
SERVO = plant_from_config({**NXT, "kind": "servo", "position_gain_pct_per_deg": 1.0}, "goal_position_rad")


def run(plant: Plant, sets: int) -> None:
    """Run `sets` sets over a moment: a few one by one, many abreast."""
    values, active = (np.repeat(each[None], sets, axis=0) for each in plant.vectors())
    signals = commanded([(0.0, 0.5)], seconds=0.1)
    with Simulator(plant.layout, workers=1) as simulator:
        simulator.run(values, active, [free_job(signals, moving(signals))])


def make(family: str) -> None:
    """Make a short case of a family."""
    plan = CasePlan("case", 5, ("viscous_friction",), "large")
    FAMILIES[family].make(Order(family, plan, "usb", 2.0))


def one() -> None:
    """Compile the motor's kernel with all that a session and its diagnosis need."""
    run(MOTOR, FEWEST)
    run(MOTOR, 1)
    Stepper([MOTOR]).step(np.ones(1), np.zeros(1, dtype=np.int64), 8.0, 1e-3)
    rehearse({"a": MOTOR}, adopting=True)


def other() -> None:
    """Compile the other plants' kernels and the truths of synthetic cases: no kernel is compiled by both halves."""
    for plant in (BODY, CART, SERVO):
        run(plant, 1)
    joint = np.zeros((1, 2))
    JointDrives([MOTOR]).turn(joint, np.ones(1), np.zeros(1, dtype=np.int64), 8.0, 1e-3)
    for family in FAMILIES:
        make(family)


if __name__ == "__main__":
    gc.disable()  # numba makes millions of small objects, and a fifth of its time went into looking through them
    {"one": one, "other": other}[sys.argv[1]]()
