"""Motors of the benchmark's own simulator with a number set by hand, recorded as a case."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from nxt_twin.blind.bench import draw_commands, draw_motor
from nxt_twin.blind.case import NOMINAL
from nxt_twin.blind.record import take
from nxt_twin.blind.truth.sensing import Sensing
from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting import settling
from nxt_twin.diagnose.fitting.everything import fit_everything
from nxt_twin.diagnose.fitting.fitter import Fitter
from nxt_twin.diagnose.fitting.noise import first_noise
from nxt_twin.recording.case import Case

FAMILIES = ("steps", "ramps", "reversals")


def recorded(seed, *, families=FAMILIES, seconds=12.0, motor=None, sensing=None, later=None, plant=None):
    """A case of one recording a family; `motor` and `sensing` change the truth, `later` that of the last alone."""
    rng = np.random.default_rng(seed)
    truth = replace(draw_motor(rng), **(motor or {}))
    runs = [draw_commands(rng, family, "usb", seconds, 0.5, 0.0) for family in families]
    taken = []
    for number, run in enumerate(runs):
        own = replace(truth, **later) if later and number == len(runs) - 1 else truth
        taken.append(take(rng, f"r{number + 1}.csv", own, Sensing(**(sensing or {})), run).recording)
    # the last is held out unless it is the one that differs
    fitted, held_out = (tuple(taken), ()) if later else (tuple(taken[:-1]), tuple(taken[-1:]))
    if later:
        held_out = (taken[0],)
        fitted = tuple(taken[1:])
    return Case("made", Path(), {"kind": "dc_motor", **(plant or NOMINAL)}, fitted, held_out, "a")


@cache
def clean_case(seed):
    return recorded(seed)


def settled(simulator, case, *, added=None):
    """The case's problem, and its baseline (with `added` effects by id and starting values) fitted to everything."""
    problem = problem_for(case)
    fitter = Fitter(simulator, problem)
    plant = problem.plant
    for effect_id, values in (added or {}).items():
        plant = plant.with_effect(effect_id, values)
    noise = first_noise(problem.plant, problem.signals, problem.scale.torque)
    rough = settling.settled(fitter, fitter.fit(plant, noise)[0].plant, noise)
    final = fit_everything(fitter, rough.plant, rough.noise)
    return problem, fitter, final
