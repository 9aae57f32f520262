"""Recordings of the benchmark's own simulator, before and after somebody touched the motor."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from nxt_twin.blind.bench import draw_commands, draw_motor
from nxt_twin.blind.case import NOMINAL
from nxt_twin.blind.record import take
from nxt_twin.blind.truth.sensing import Sensing
from nxt_twin.blind.truth.surprises import PERIODIC_PUSH
from nxt_twin.diagnose.changed.compare import changed
from nxt_twin.recording.case import Case


def touched(truth, **factors):
    """The motor with some of its numbers multiplied."""
    return replace(truth, **{name: factor * getattr(truth, name) for name, factor in factors.items()})


def side(rng, name, truth, families=("steps", "reversals")):
    runs = [draw_commands(rng, family, "usb", 4.5, 0.5, 0.0) for family in families]
    taken = [take(rng, f"{name}-{n}.csv", truth, Sensing(), run).recording for n, run in enumerate(runs)]
    return Case(name, Path(), {"kind": "dc_motor", **NOMINAL}, tuple(taken), (), "a")


@cache
def pair(seed, what):
    """Both sides; `what` names what was done between them."""
    rng = np.random.default_rng(seed)
    truth = draw_motor(rng)
    rubbed = touched(truth, coulomb_forward_nm=3.0, coulomb_reverse_nm=3.0)
    after = {
        "nothing": truth,
        "supply": replace(truth, battery_v=0.8 * truth.battery_v),
        "inertia": touched(truth, inertia_kg_m2=1.6),
        "a push every so often": replace(
            truth,
            surprise=float(PERIODIC_PUSH),
            surprise_a=0.2,
            surprise_b=2.3,
            surprise_c=0.4,
            surprise_d=0.7,
        ),
        "load behind play": replace(truth, gap_rad=np.radians(8.0), load_inertia_kg_m2=0.001),
        "band and friction": replace(rubbed, band_stiffness_nm_per_rad=0.02),
    }[what]
    sides = side(rng, "before", truth), side(rng, "after", after)
    return tuple(map(unread, sides)) if what == "supply" else sides


def unread(case):
    """The side with nobody reading the battery."""
    runs = [
        replace(run, columns={name: values for name, values in run.columns.items() if name != "battery_v"})
        for run in case.recordings
    ]
    return replace(case, recordings=tuple(runs))


@cache
def answer(seed, what):
    before, after = pair(seed, what)
    return changed(before, [after])[0]
