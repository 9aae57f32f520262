"""When commands act and when readings are taken."""

from dataclasses import replace

import numpy as np
import pytest
from physics_samples import commanded, job_with_readings, motion, nxt

from nxt_twin.physics.layout import Slot
from nxt_twin.physics.stepper import Stepper

STEPS = [(0.0, 0.0), (0.1, 0.7), (0.5, -0.4), (0.9, 0.3)]
A_TENTH_OF_A_DEGREE = np.radians(0.1)


@pytest.mark.parametrize("early_s", [0.01, 0.03])
def test_a_negative_command_delay_has_commands_act_before_their_rows(motor_simulator, early_s):
    run = commanded(STEPS, seconds=1.5)
    early = nxt(effects={"command_delay": {"delay_s": -early_s}})
    rows = round(early_s / 0.01)
    written = motion(motor_simulator, nxt(), run)["angle"]
    acted = motion(motor_simulator, early, run)["angle"]
    np.testing.assert_allclose(acted[:-rows], written[rows:], rtol=1e-9, atol=1e-9)


def test_a_stepped_plant_s_command_never_acts_before_it_is_given():
    stepper = Stepper([nxt(), nxt(effects={"command_delay": {"delay_s": -0.02}})])
    for tick in range(80):
        stepper.step(np.full(2, 0.6 if tick > 20 else 0.0), np.zeros(2, dtype=np.int64), 8.0, 1e-3)
    assert stepper.angle[0] == stepper.angle[1] > 0.0


@pytest.mark.parametrize("delay_s", [0.01, 0.03, 0.2])
def test_a_command_delay_moves_the_response_by_exactly_that_much(motor_simulator, delay_s):
    run = commanded(STEPS, seconds=1.5)
    delayed = nxt(effects={"command_delay": {"delay_s": delay_s}})
    rows = round(delay_s / 0.01)
    prompt = motion(motor_simulator, nxt(), run)["angle"]
    late = motion(motor_simulator, delayed, run)["angle"]
    np.testing.assert_allclose(late[rows:], prompt[:-rows], rtol=1e-9, atol=1e-9)


def test_a_stepped_plant_s_command_is_late_by_the_same_delay():
    stepper = Stepper([nxt(), nxt(effects={"command_delay": {"delay_s": 0.02}})])
    angles = []
    for tick in range(120):
        duty = 0.6 if tick < 60 else -0.6
        stepper.step(np.full(2, duty), np.zeros(2, dtype=np.int64), 8.0, 1e-3)
        angles.append(stepper.angle.copy())
    prompt, late = np.array(angles).T
    np.testing.assert_allclose(late[20:], prompt[:-20], atol=1e-12)
    assert np.all(late[:20] == 0.0)


def test_irregular_stamps_show_the_same_motion_as_regular_ones(motor_simulator):
    plant = nxt(effects={"gravity_load": {"gravity_torque_nm": 0.03, "phase_deg": 10.0}})
    regular = commanded(STEPS, seconds=1.5)
    extra = np.random.default_rng(5).uniform(0.0, 1.5, 300)
    kept = regular.time_s[::5]
    stamps = np.unique(np.concatenate([kept, extra]))
    irregular = commanded(STEPS, seconds=1.5, stamps=stamps)
    expected = motion(motor_simulator, plant, regular)["angle"][::5]
    found = motion(motor_simulator, plant, irregular)["angle"][np.searchsorted(stamps, kept)]
    np.testing.assert_allclose(found, expected, atol=A_TENTH_OF_A_DEGREE)
    assert np.ptp(expected) > 1.0


def test_commands_between_stamps_act_when_they_were_given(motor_simulator):
    coarse = commanded(STEPS, seconds=1.5, every_s=0.25)
    fine = commanded(STEPS, seconds=1.5)
    expected = motion(motor_simulator, nxt(), fine)["angle"][::25]
    np.testing.assert_allclose(
        motion(motor_simulator, nxt(), coarse)["angle"], expected, atol=A_TENTH_OF_A_DEGREE
    )


def test_stamps_far_apart_or_far_from_zero_change_nothing(motor_simulator):
    late = commanded(
        [(t + 1e6, level) for t, level in STEPS], seconds=1.5, stamps=np.arange(151) * 0.01 + 1e6
    )
    prompt = motion(motor_simulator, nxt(), commanded(STEPS, seconds=1.5))["angle"]
    np.testing.assert_allclose(
        motion(motor_simulator, nxt(), late)["angle"], prompt, atol=A_TENTH_OF_A_DEGREE
    )


def test_a_reading_that_stands_still_while_the_motor_runs_counts_as_stale(motor_simulator):
    job = job_with_readings(motor_simulator, seconds=2.0)
    doubting = nxt(effects={"stale_samples": {"stale_fraction": 0.05}})
    speed = motor_simulator.trace(nxt(), job)["speed"]
    known = np.flatnonzero(np.isfinite(job.signals.measured))
    fast = known[np.abs(speed[known]) > 8.0]
    row = fast[fast.size // 2]
    before = known[known < row][-1]
    job.signals.measured[row] = job.signals.measured[before]
    weight = motor_simulator.trace(doubting, job)["weight"]
    assert weight[row] < 0.05
    assert np.median(weight[fast[fast < row]]) > 0.9
    assert np.all(motor_simulator.trace(nxt(), job)["weight"][known[1:]] == 1.0)


def test_a_held_reading_is_half_a_period_old_on_average_and_counts_less_the_faster_the_motor(motor_simulator):
    period_s = 0.04
    held = nxt(effects={"sample_hold": {"refresh_period_s": period_s}})
    run = commanded([(0.0, 0.7)], seconds=1.0)
    prompt, old = (motion(motor_simulator, plant, run)["predicted"] for plant in (nxt(), held))
    np.testing.assert_allclose(old[2:], prompt[:-2], atol=A_TENTH_OF_A_DEGREE)
    job = job_with_readings(motor_simulator, seconds=2.0)
    trace = motor_simulator.trace(held, job)
    read = np.flatnonzero(np.isfinite(job.signals.measured))[1:]
    ordinary = job.observer.innovation_std[read] ** 2
    strayed = (period_s * trace["speed"][read]) ** 2 / 12.0
    fast = np.abs(trace["speed"][read]) > 8.0  # shown after the correction, which moves a slow one too much
    expected = ordinary / (ordinary + strayed)
    np.testing.assert_allclose(trace["weight"][read][fast], expected[fast], rtol=0.2)
    assert expected[fast].max() < 0.05


def test_a_held_reading_is_as_old_as_it_has_been_shown(motor_simulator):
    held = nxt(effects={"sample_hold": {"refresh_period_s": 0.04}})
    run = commanded([(0.0, 0.7)], seconds=1.0)
    shown_s = 0.01 * (np.arange(run.time_s.size) % 4)
    known = replace(
        run, ages=np.column_stack([shown_s, np.full(run.time_s.size, 0.02), 0.0 * shown_s, 0.0 * shown_s])
    )
    taken = replace(run, time_s=run.time_s - 0.01 - shown_s)
    wanted = motion(motor_simulator, nxt(), replace(taken, time_s=np.maximum(taken.time_s, 0.0)))["predicted"]
    found = motion(motor_simulator, held, known)["predicted"]
    np.testing.assert_allclose(found[4:], wanted[4:], atol=A_TENTH_OF_A_DEGREE)


@pytest.mark.parametrize(("share", "beside"), [(1.0, 0), (0.6, 0), (-0.8, 1)])
def test_a_loop_that_writes_at_its_end_is_late_by_its_own_length(motor_simulator, share, beside):
    run = commanded(STEPS, seconds=1.5)
    longer_s = np.random.default_rng(4).uniform(0.0, 0.03, (run.command_time_s.size, 2))
    moved = replace(run, command_time_s=run.command_time_s + 0.005 + share * longer_s[:, beside])
    late = nxt(effects={"command_delay": {"delay_s": 0.005, "poll_share": share}})
    found = motion(motor_simulator, late, replace(run, command_polls=longer_s))["angle"]
    np.testing.assert_allclose(found, motion(motor_simulator, nxt(), moved)["angle"], rtol=1e-9, atol=1e-9)


LAG = {"lag_span_s": 0.08, "lag_period_s": 1.4, "lag_phase": 0.2, "rate_error": 0.0}


def test_a_clock_that_stamps_whole_rows_late_shows_the_motion_of_earlier_commands(motor_simulator):
    run = commanded(STEPS, seconds=1.5)
    lag_s = 0.08 * (0.5 + 0.5 * np.cos(2.0 * np.pi * (run.time_s / 1.4 + 0.2)))
    command_lag_s = 0.08 * (0.5 + 0.5 * np.cos(2.0 * np.pi * (run.command_time_s / 1.4 + 0.2)))
    true = replace(run, time_s=run.time_s - lag_s, command_time_s=run.command_time_s - command_lag_s)
    wanted = motion(motor_simulator, nxt(), true)["angle"]
    rows = motion(motor_simulator, nxt(effects={"clock_skew": {**LAG, "lag_of_commands": 1.0}}), run)["angle"]
    np.testing.assert_allclose(rows, wanted, atol=A_TENTH_OF_A_DEGREE)
    readings = motion(motor_simulator, nxt(effects={"clock_skew": LAG}), run)["angle"]
    assert np.abs(readings - wanted).max() > 10.0 * A_TENTH_OF_A_DEGREE


def test_rows_that_are_late_by_chance_show_the_motion_of_when_they_were_taken(motor_simulator):
    run = commanded(STEPS, seconds=1.5)
    late = np.random.default_rng(3).uniform(-0.5, 0.5, run.time_s.size)
    command_late = np.interp(run.command_time_s, run.time_s, late)
    stamped = replace(
        run,
        time_s=run.time_s + 0.02 * (0.5 + late),
        command_time_s=run.command_time_s + 0.02 * (0.5 + command_late),
        ages=np.column_stack([np.full((late.size, 2), -1.0), late, 0.0 * late]),
        command_late=command_late,
    )
    by_rows = {"lag_span_s": 0.02, "rate_error": 0.0, "lag_waves": 0.0, "lag_of_commands": 1.0}
    found = motion(motor_simulator, nxt(effects={"clock_skew": by_rows}), stamped)["angle"]
    np.testing.assert_allclose(found, motion(motor_simulator, nxt(), run)["angle"], atol=A_TENTH_OF_A_DEGREE)


def test_a_reading_strays_by_how_far_its_lateness_is_open_times_the_speed(motor_simulator):
    by_rows = {"lag_span_s": 0.03, "rate_error": 0.0, "lag_waves": 0.0}
    late = nxt(effects={"clock_skew": by_rows})
    job = job_with_readings(motor_simulator, seconds=2.0)
    rows = job.signals.time_s.size
    told = np.column_stack([np.full((rows, 2), -1.0), np.zeros(rows), np.full(rows, 0.1)])
    job = replace(job, signals=replace(job.signals, ages=told))
    trace = motor_simulator.trace(late, job)
    read = np.flatnonzero(np.isfinite(job.signals.measured))[1:]
    ordinary = job.observer.innovation_std[read] ** 2
    strayed = (0.1 * 0.03 * trace["speed"][read]) ** 2
    fast = np.abs(trace["speed"][read]) > 8.0
    expected = ordinary / (ordinary + strayed)
    np.testing.assert_allclose(trace["weight"][read][fast], expected[fast], rtol=0.2)
    assert expected[fast].max() < 0.7
    wandering = motor_simulator.trace(nxt(effects={"clock_skew": {**by_rows, "lag_waves": 1.0}}), job)
    np.testing.assert_allclose(wandering["weight"][read], 1.0)


def lag_s(stamp_s, **lag):
    """What the effect's own term gives, by the names of a plant file."""
    plant = nxt(effects={"clock_skew": {**LAG, **lag}})
    effect = plant.layout.effect("clock_skew")
    values = {p.symbol: plant.values[Slot("clock_skew", p.symbol)] for p in effect.parameters}
    del values["rate_error"], values["of_commands"]
    return np.array([effect.terms["lag"](float(at), late=0.0, **values) for at in stamp_s])


def test_a_straight_lag_that_rises_for_most_of_a_period_is_a_sawtooth():
    period_s = LAG["lag_period_s"]
    saw = {"lag_phase": 0.0, "lag_rise": 0.9, "lag_straightness": 1.0}
    at_s = np.array([0.0, 0.05, 0.1, 0.55, 1.0, 1.05]) * period_s
    np.testing.assert_allclose(
        lag_s(at_s, **saw), 0.08 * np.array([1.0, 0.5, 0.0, 0.5, 1.0, 0.5]), atol=1e-12
    )


def test_a_second_wave_takes_its_share_of_the_span():
    at_s = np.linspace(0.0, 5.0, 40)
    first = np.cos(2.0 * np.pi * (at_s / 1.4 + 0.2))
    second = np.cos(2.0 * np.pi * (at_s / 0.7 - 0.1))
    both = {"lag_second_share": 0.25, "lag_second_period_s": 0.7, "lag_second_phase": -0.1}
    wanted = 0.08 * (0.5 + 0.5 * (0.75 * first + 0.25 * second))
    np.testing.assert_allclose(lag_s(at_s, **both), wanted, atol=1e-12)


def test_a_second_wave_that_is_not_there_is_in_no_plant_file():
    kept = nxt(effects={"clock_skew": LAG}).to_config()["effects"]["clock_skew"]
    assert not any("second" in name for name in kept)
