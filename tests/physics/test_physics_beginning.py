"""A recording that begins with a command: whether the machine stood still before it."""

from dataclasses import replace

import numpy as np
import pytest
from physics_samples import commanded
from scipy.integrate import solve_ivp

from nxt_twin.physics.beginning import begins_at_rest, goes_off_at_once
from nxt_twin.physics.start import driven_before, moving_start, run_in, windows

QUANTUM = np.radians(1.0)


def motion(time_s, duty, *, speed=0.0, lag_s=0.06, top_speed=15.0):
    """The angle of a motor whose speed follows `duty(t)`, from `speed` at time 0, rad."""

    def rates(t, state):
        return [state[1], (top_speed * duty(t) - state[1]) / lag_s]

    found = solve_ivp(rates, (0.0, time_s[-1]), [0.2, speed], t_eval=time_s, rtol=1e-8, max_step=0.005)
    return found.y[0]


def read(time_s, angle, pieces, *, quantum=QUANTUM):
    run = commanded(pieces, seconds=time_s[-1], stamps=time_s)
    counts = np.floor(angle / quantum) * quantum
    return replace(run, measured=counts, quantum=quantum)


@pytest.mark.parametrize("interval_s", [0.008, 0.03])
@pytest.mark.parametrize("duty", [-0.9, -0.4, 0.6])
def test_a_command_in_the_first_row_sets_a_motor_going_from_rest(interval_s, duty):
    time_s = np.arange(0.0, 2.0, interval_s)
    signals = read(time_s, motion(time_s, lambda _: duty), [(0.0, duty)])
    assert begins_at_rest(signals)
    assert moving_start(signals).speed[0] == 0.0


@pytest.mark.parametrize("interval_s", [0.008, 0.03])
@pytest.mark.parametrize("late_s", [0.0, 0.014, 0.03])
def test_a_loop_that_turns_its_command_down_at_once_sets_a_motor_going_from_rest(interval_s, late_s):
    time_s = np.arange(0.0, 2.0, interval_s)
    levels = np.clip(1.0 - 9.0 * (time_s - 2.0 * interval_s), 0.1, 1.0)

    def duty(t):
        return levels[int((t - late_s) / interval_s)] if t >= late_s else 0.0

    signals = read(time_s, motion(time_s, duty), list(zip(time_s.tolist(), levels.tolist(), strict=True)))
    assert begins_at_rest(signals)


@pytest.mark.parametrize("interval_s", [0.02, 0.04])
def test_a_motor_on_its_way_since_a_command_before_the_first_row_does_not_begin_at_rest(interval_s):
    early_s = 0.5 * interval_s
    time_s = np.arange(0.0, 2.0, interval_s)
    angle = motion(np.append(0.0, time_s + early_s), lambda _: 0.6)[1:]
    signals = read(time_s, angle, [(0.0, 0.6)], quantum=np.radians(0.25))
    assert not begins_at_rest(signals)
    assert run_in(signals).any()


@pytest.mark.parametrize(("lag_s", "begins"), [(0.0, True), (0.09, True), (0.2, False)])
def test_a_motor_that_goes_off_quicker_than_the_plant_could_was_on_its_way_before(lag_s, begins):
    time_s = np.arange(0.0, 2.0, 0.02)
    signals = replace(read(time_s, motion(time_s, lambda _: 0.6, lag_s=0.05), [(0.0, 0.6)]), lag_s=lag_s)
    assert begins_at_rest(signals) is begins


@pytest.mark.parametrize("interval_s", [0.008, 0.01])
def test_a_motor_that_makes_a_few_counts_shows_a_start_from_rest(interval_s):
    time_s = np.arange(0.0, 2.0, interval_s)
    slow = read(time_s, motion(time_s, lambda _: 0.12), [(0.0, 0.12)])
    assert np.ptp(slow.measured[time_s < 0.12]) < np.radians(9.0)
    assert begins_at_rest(slow)
    rolling = read(time_s, motion(time_s, lambda _: 0.12, speed=1.8), [(0.0, 0.12)])
    assert not begins_at_rest(rolling)


@pytest.mark.parametrize("interval_s", [0.01, 0.03])
def test_a_few_counts_of_a_constant_speed_show_no_rest(interval_s):
    time_s = np.arange(0.0, 2.0, interval_s)
    creeping = read(time_s, motion(time_s, lambda _: 0.02, speed=0.3), [(0.0, 0.02)])
    assert np.ptp(creeping.measured[time_s < 0.12]) > 0.0
    assert not begins_at_rest(creeping)


@pytest.mark.parametrize("load", [0.25, 0.35])
def test_dry_friction_hides_no_rest_from_a_fine_encoder(load):
    time_s = np.arange(0.0, 2.0, 0.01)
    levels = np.clip(1.0 - 7.0 * time_s, 0.1, 1.0)
    angle = motion(time_s, lambda t: levels[int(t / 0.01)] - load)
    fine = read(
        time_s, angle, list(zip(time_s.tolist(), levels.tolist(), strict=True)), quantum=np.radians(0.1)
    )
    assert begins_at_rest(fine)


def test_readings_that_neither_motion_fits_show_no_rest():
    time_s = np.arange(0.0, 2.0, 0.008)
    held_s = 0.048 * np.floor(time_s / 0.048)
    angle = np.interp(held_s, time_s, motion(time_s, lambda _: 0.9, speed=4.0))
    assert not begins_at_rest(read(time_s, angle, [(0.0, 0.9)]))


@pytest.mark.parametrize("interval_s", [0.008, 0.03])
def test_a_command_soon_after_the_first_row_does_not_move_the_motor_before(interval_s):
    time_s = np.arange(0.0, 2.0, interval_s)
    late_s = 1.5 * interval_s
    angle = motion(time_s, lambda t: 0.8 * (t >= late_s))
    assert moving_start(read(time_s, angle, [(0.0, 0.0), (late_s, 0.8)])).speed[0] == 0.0


@pytest.mark.parametrize("interval_s", [0.008, 0.03])
@pytest.mark.parametrize(("duty", "speed"), [(0.6, 9.0), (0.6, -9.0), (-0.5, 6.0), (0.9, 5.0)])
def test_a_recording_cut_out_of_a_motion_begins_moving(interval_s, duty, speed):
    time_s = np.arange(0.0, 2.0, interval_s)
    signals = read(time_s, motion(time_s, lambda _: duty, speed=speed), [(0.0, duty)])
    assert not begins_at_rest(signals)
    assert moving_start(signals).speed[0] / speed > 0.5


def test_the_first_window_of_a_recording_that_begins_moving_begins_anew_after_a_run_in():
    time_s = np.arange(0.0, 3.0, 0.01)
    moving = read(time_s, motion(time_s, lambda _: 0.6, speed=-9.0), [(0.0, 0.6)])
    still = read(time_s, motion(time_s, lambda _: 0.6), [(0.0, 0.6)])
    assert time_s[windows(moving, 1.0)] == pytest.approx([0.0, 0.3, 1.0, 2.0])
    assert run_in(moving).sum() == 30
    assert time_s[windows(still, 1.0)] == pytest.approx([0.0, 1.0, 2.0])
    assert not run_in(still).any()


@pytest.mark.parametrize("duty", [-1.0, 0.4])
@pytest.mark.parametrize(("late_s", "at_once"), [(0.0, True), (0.015, False), (0.03, False), (0.06, False)])
def test_a_motor_that_is_let_go_at_the_first_row_was_commanded_before_it(duty, late_s, at_once):
    time_s = np.arange(0.0, 2.0, 0.01)
    angle = motion(time_s, lambda t: duty if t >= late_s else 0.0)
    signals = read(time_s, angle, [(0.0, duty), (1.0, -duty)])
    assert goes_off_at_once(signals) is at_once
    assert bool(driven_before(signals).command_time_s[0] < 0.0) is at_once


def test_a_motor_that_nothing_drives_at_first_does_not_go_off():
    time_s = np.arange(0.0, 2.0, 0.01)
    signals = read(time_s, motion(time_s, lambda t: float(t >= 0.5)), [(0.0, 0.0), (0.5, 1.0)])
    assert not goes_off_at_once(signals)


def test_what_moves_at_the_first_row_was_driven_before_it():
    time_s = np.arange(0.0, 3.0, 0.01)
    moving = read(time_s, motion(time_s, lambda _: 0.6, speed=9.0), [(0.0, 0.6), (1.0, 0.0)])
    still = read(time_s, motion(time_s, lambda t: 0.6 if t >= 0.03 else 0.0), [(0.0, 0.6)])
    assert driven_before(moving).command_time_s.tolist() == [-1.0, 1.0]
    assert driven_before(still).command_time_s.tolist() == [0.0]


def held(time_s, angle, pieces, *, held_s, phase_s):
    """What a device shows that refreshes its reading each `held_s`, with the ages that repeats tell."""
    taken_s = held_s * np.floor((time_s - phase_s) / held_s) + phase_s
    counts = np.floor(np.interp(np.maximum(taken_s, 0.0), time_s, angle) / QUANTUM) * QUANTUM
    run = commanded(pieces, seconds=time_s[-1], stamps=time_s)
    poll_s = time_s[1] - time_s[0]
    shown_s = np.where(taken_s > 0.0, poll_s * np.floor((time_s - taken_s) / poll_s), -1.0)
    ages = np.column_stack([shown_s, np.where(taken_s > 0.0, poll_s, -1.0), *np.zeros((2, time_s.size))])
    return replace(run, measured=counts, quantum=QUANTUM, ages=ages, refreshed_s=held_s)


@pytest.mark.parametrize("held_s", [0.03, 0.05, 0.08])
@pytest.mark.parametrize("phase_s", [0.002, 0.02])
def test_readings_that_a_device_holds_show_a_start_from_rest(held_s, phase_s):
    time_s = np.arange(0.0, 2.0, 0.015)
    levels = np.clip(1.0 - 5.0 * time_s, 0.1, 1.0)
    angle = motion(time_s, lambda t: levels[int(t / 0.015)])
    pieces = list(zip(time_s.tolist(), levels.tolist(), strict=True))
    signals = held(time_s, angle, pieces, held_s=held_s, phase_s=phase_s)
    assert begins_at_rest(signals)
    assert moving_start(signals).speed[0] == 0.0


@pytest.mark.parametrize("held_s", [0.03, 0.05])
def test_held_readings_of_a_motor_that_moves_show_no_rest(held_s):
    time_s = np.arange(0.0, 2.0, 0.015)
    angle = motion(time_s, lambda _: 0.6, speed=9.0)
    assert not begins_at_rest(held(time_s, angle, [(0.0, 0.6)], held_s=held_s, phase_s=0.01))
