"""Two causes of which a search knows where to look: readings that are held, and torque that ripples with the angle.

The simulators of the truth share no code with the fit: a family's of the blind sets, and the one below.
"""

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from nxt_twin.blind.pairs.bench import bench_of
from nxt_twin.diagnose.changed.candidates import MOST_CYCLES, rhythms
from nxt_twin.diagnose.changed.compare import changed
from nxt_twin.diagnose.changed.engine import ready_pairs
from nxt_twin.diagnose.changed.joint import JointFitter
from nxt_twin.diagnose.fitting.held import are_held, hold_came_in
from nxt_twin.recording.case import Case
from nxt_twin.recording.recording import Recording

PLANT = {
    "kind": "dc_motor",
    "resistance_ohm": 6.7,
    "torque_constant_nm_per_a": 0.3,
    "back_emf_v_s_per_rad": 0.3,
    "inertia_kg_m2": 6.2e-4,
    "coulomb_friction_nm": 0.011,
    "viscous_friction_nm_s_per_rad": 1.1e-3,
    "supply_v": 7.4,
}
ROWS, INTERVAL_S, STEPS_A_ROW = 800, 0.01, 50


def slow_powers(rng):
    """Held for 0.3 to 1.1 s each, 15 to 45 % either way: ripple shows at slow turning."""
    power_pct = np.zeros(ROWS)
    row = 20
    while row < ROWS:
        rows = int(rng.uniform(30, 110))
        power_pct[row : row + rows] = round(rng.uniform(15.0, 45.0) * rng.choice((-1.0, 1.0)))
        row += rows
    return power_pct


def turned(rng, name, ripple, cycles=20.0):
    """A motor whose torque constant ripples, by small explicit steps."""
    power_pct, angle, speed = slow_powers(rng), 0.0, 0.0
    read_deg, step_s = np.zeros(ROWS), INTERVAL_S / STEPS_A_ROW
    for row in range(ROWS):
        read_deg[row] = math.floor(math.degrees(angle))
        for _ in range(STEPS_A_ROW):
            current = (7.4 * power_pct[row] / 100.0 - 0.3 * speed) / 6.7
            torque = 0.3 * current * (1.0 + ripple * math.cos(cycles * angle + 0.7))
            torque -= 1e-3 * speed + 0.012 * math.tanh(speed / 0.02)
            speed += step_s * torque / 6e-4
            angle += step_s * speed
    volts = np.where(np.arange(ROWS) % 20 == 0, 7.4, np.nan)
    columns = {
        "time_s": np.arange(ROWS) * INTERVAL_S,
        "a_power_pct": power_pct,
        "a_tacho_deg": read_deg,
        "battery_v": volts,
    }
    return Recording(name=name, columns=columns)


def rippling(seed, ripple):
    """Sides without and with ripple."""
    rng = np.random.default_rng(seed)
    sides = {"before": 0.0, "after": ripple}
    return [
        Case(name, Path(), PLANT, tuple(turned(rng, f"{name}-{n}.csv", size) for n in (1, 2)), (), "a")
        for name, size in sides.items()
    ]


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "ripple"), [(3, 0.3), (4, 0.5)])
def test_ripple_of_twenty_a_turn_that_came_in_is_named_with_its_size(seed, ripple):
    before, after = rippling(seed, ripple)
    (found,) = changed(before, [after])
    (change,) = found.changes
    assert (found.verdict, change.of) == ("changed", "commutation_ripple")
    assert change.params["cycles_per_turn"].value == pytest.approx(20.0, abs=0.1)
    assert change.params["ripple_fraction"].value == pytest.approx(ripple, rel=0.2)


def test_each_whole_number_of_cycles_a_turn_is_tried():
    before, after = rippling(3, 0.3)
    (pair,) = ready_pairs(before, [after])
    fitter = JointFitter(None, pair.windows.sides, pair.tolerance)
    every = rhythms(fitter, pair.model, pair.problems[0].scale)
    tried = {dict(each.start)["commutations"] for each in every if each.effect == "commutation_ripple"}
    assert tried == set(map(float, range(2, 41)))
    assert MOST_CYCLES == 40


def held(family, seed, refresh_s):
    """Sides of a drawn motor, the one after with readings refreshed each `refresh_s`."""
    rng = np.random.default_rng(seed)
    bench = bench_of(rng, family)
    chains = {
        "before": bench.truth,
        "after": replace(bench.truth, chain=replace(bench.truth.chain, refresh_period_s=refresh_s)),
    }
    plant = {"kind": "dc_motor", **bench.plant}
    return [
        Case(name, Path(), plant, bench.record(rng, truth, name), (), "a") for name, truth in chains.items()
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("family", "seed", "told_s"), [("stiff", 4, 0.02), ("workshop", 5, 0.025), ("mujoco", 3, 0.025)]
)
def test_a_reading_held_for_25_ms_is_named_and_no_late_command(family, seed, told_s):
    before, after = held(family, seed, 0.025)
    (found,) = changed(before, [after])
    (change,) = found.changes
    assert (found.verdict, change.of) == ("changed", "sample_hold")
    assert change.after == pytest.approx(told_s, rel=0.12)


def readings(jumps, after_repeats):
    """Readings that jump by three steps; so many of them after a repeated reading, the others after a moving one."""
    moved = [0.0, 3.0] * after_repeats + [2.0, 3.0] * (jumps - after_repeats)
    return SimpleNamespace(measured=np.cumsum([0.0, 2.0, *moved]), quantum=1.0)


@pytest.mark.parametrize(
    ("jumps", "after_repeats", "are"), [(100, 40, False), (100, 41, True), (29, 29, False)]
)
def test_readings_are_held_of_which_more_than_two_fifths_of_the_jumps_follow_a_repeat(
    jumps, after_repeats, are
):
    assert are_held([readings(jumps, after_repeats)]) == are


def test_readings_that_were_held_before_are_no_change():
    loose, stuck = [readings(100, 2)], [readings(100, 90)]
    assert hold_came_in(loose, stuck)
    assert not hold_came_in(stuck, stuck)
