"""Readings that leap away and back are left out and told; what a motor does is not."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import nxt_twin as nt
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.diagnose.fitting.leaps import leaps, without_leaps
from nxt_twin.physics.recorded import signals_of
from nxt_twin.recording.case import Case

ROWS = 400
STEP_DEG = 2.0  # between two readings, but for a slow beginning


def read(angle_deg):
    """Signals of a motor that was read at these angles, each 10 ms."""
    columns = {
        "time_s": np.arange(len(angle_deg)) * 0.01,
        "a_power_pct": np.full(len(angle_deg), 50.0),
        "a_tacho_deg": np.asarray(angle_deg, dtype=float),
    }
    return signals_of(nt.Recording("r", columns), "a")


def ramp():
    return np.cumsum(np.where(np.arange(ROWS) < 100, 1.0, STEP_DEG))


def leapt(size_deg, at=(200,), back_deg=0.0):
    angle = ramp()
    angle[list(at)] += size_deg
    angle[max(at) + 1 :] += back_deg
    return leaps(read(angle))


@pytest.mark.parametrize("at", [(200,), (200, 201), (200, 201, 202), (50, 120, 300)])
@pytest.mark.parametrize("size_deg", [-180.0, 60.0])
def test_readings_that_leap_away_and_back_are_found(at, size_deg):
    assert np.flatnonzero(leapt(size_deg, at)).tolist() == list(at)


@pytest.mark.parametrize(
    ("size_deg", "at", "back_deg"),
    [
        (-180.0, (200, 201, 202, 203), 0.0),  # too long
        (-180.0, (0,), 0.0),  # nothing before it
        (-180.0, (200,), -180.0),  # stays there
        (360.0, tuple(range(200, ROWS)), 0.0),  # wraps
        (60.0, tuple(range(10, 390, 20)), 0.0),  # too many
    ],
)
def test_what_stays_lasts_or_repeats_is_no_leap(size_deg, at, back_deg):
    assert not leapt(size_deg, at, back_deg).any()


@pytest.mark.parametrize(("times", "found"), [(3.1, True), (2.9, False)])
def test_a_leap_is_three_times_as_large_as_any_other_step(times, found):
    angle = 10.0 * ramp()  # so that ten steps of the encoder are less
    angle[200] += 10.0 * STEP_DEG * (times + 1.0)  # the way back is shorter by a step of the ramp
    assert leaps(read(angle)).any() == found


@pytest.mark.parametrize(("size_deg", "found"), [(11.0, True), (10.0, False)])
def test_a_leap_is_larger_than_ten_steps_of_the_encoder(size_deg, found):
    angle = np.zeros(ROWS)
    angle[100:] = 1.0
    angle[200] += size_deg
    assert leaps(read(angle)).any() == found


@pytest.mark.parametrize(("apart_deg", "found"), [(44.0, True), (46.0, False)])
def test_readings_that_leap_together_lie_near_each_other(apart_deg, found):
    angle = np.zeros(ROWS)
    angle[200:202] = 90.0, 90.0 + apart_deg
    assert leaps(read(angle)).any() == found


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    interval_s=st.floats(0.005, 0.1),
    quantum_deg=st.sampled_from([0.0, 0.1, 1.0]),
    late=st.floats(0.0, 0.2),
)
def test_a_motor_never_leaps(seed, interval_s, quantum_deg, late):
    """Driven at random, read late, and stopped hard at both ends."""
    rng = np.random.default_rng(seed)
    drive = np.repeat(rng.uniform(-800.0, 800.0, ROWS // 20), 20)
    speed, angle, seen = 0.0, 0.0, []
    for goal in drive:
        speed += (goal - speed) * (1.0 - math.exp(-interval_s / 0.07))
        angle += interval_s * speed
        if abs(angle) > 300.0:
            angle, speed = math.copysign(300.0, angle), -0.5 * speed
        seen.append(seen[-1] if seen and rng.random() < late else angle)
    shown = np.round(np.array(seen) / quantum_deg) * quantum_deg if quantum_deg else np.array(seen)
    signals = read(shown)
    assert not leaps(signals).any()
    assert without_leaps(signals) is signals


def test_readings_of_any_size_are_compared():
    angle = 1e300 * ramp()
    assert not leaps(read(angle)).any()
    angle[200] = -1e307
    assert np.flatnonzero(leaps(read(angle))).tolist() == [200]


def test_a_missing_reading_between_is_passed_over():
    angle = ramp()
    angle[[200, 202]] = -180.0
    angle[201] = np.nan
    signals = read(angle)
    assert np.flatnonzero(leaps(signals)).tolist() == [200, 202]
    assert np.isnan(without_leaps(signals).measured[200:203]).all()


@pytest.mark.slow
def test_a_diagnosis_leaves_leaps_out_and_tells_them():
    plant = nt.load_plant("nxt_motor")
    rng = np.random.default_rng(3)
    runs = []
    for name in ("first", "second", "third"):
        time_s = np.arange(0.0, 8.0, 0.01)
        power = np.repeat(rng.integers(-100, 100, 16), 50)
        made = nt.simulate(plant, nt.Recording(name, {"time_s": time_s, "a_power_pct": power}))
        angle = np.round(made.columns["a_tacho_deg"])
        angle[[100, 400, 401]] = -100_000.0
        runs.append(replace(made, columns={**made.columns, "a_tacho_deg": angle}))
    found = diagnose(Case("leaping", Path(), plant.to_config(), tuple(runs), (), "a")).diagnosis
    assert found.verdict == "adequate"
    assert found.fit.improved < 2.0
    told = [note for note in found.notes if "3 readings leap away and back" in note]
    assert len(told) == 3
    assert "at 1.000, 4.000, 4.010 s" in told[0]
