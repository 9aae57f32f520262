"""Effects with a state, a bounce or a time of their own, each against its law written out again."""

import math

import numpy as np
import pytest
from physics_samples import NXT, commanded, disc, motion, moving, nxt
from scipy.integrate import solve_ivp

from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.signals import in_session
from nxt_twin.physics.simulate import free_job
from nxt_twin.physics.start import Start

INERTIA = 2e-3
TC = 0.02


def bristled(**keys):
    return disc(coulomb_friction=TC, effects={"presliding": {"presliding_deg": 5.0}}, **keys)


def test_bristles_bend_and_slide_by_dahl_s_law(rotary_simulator):
    levels = [(0.0, 0.03), (0.4, -0.035), (0.9, 0.012)]
    run = commanded(levels, seconds=1.4, kind="torque_nm")
    reach = math.radians(5.0)

    def rates(t, x):
        torque = [level for at, level in levels if at <= t][-1]
        _, speed, bend = x
        return speed, (torque - TC * bend) / INERTIA, (speed - abs(speed) * bend) / reach

    state, expected = [0.0, 0.0, 0.0], np.zeros(run.time_s.size)
    for (low, _), high in zip(levels, [0.4, 0.9, 1.4], strict=True):
        rows = np.flatnonzero((run.time_s > low + 1e-9) & (run.time_s <= high + 1e-9))
        span = (low, high - 1e-12)
        stamps = np.minimum(run.time_s[rows], span[1])
        found = solve_ivp(rates, span, state, t_eval=stamps, rtol=1e-9, atol=1e-10)
        expected[rows], state = found.y[0], found.y[:, -1]
    angle = motion(rotary_simulator, bristled(), run)["angle"]
    assert np.abs(angle - expected).max() < 2e-3
    assert np.ptp(expected) > 1.0


def test_a_push_below_sliding_only_bends_the_bristles_and_they_spring_back(rotary_simulator):
    run = commanded([(0.0, 0.01), (2.5, 0.0)], seconds=5.0, kind="torque_nm")
    angle = motion(rotary_simulator, bristled(viscous_friction=0.05), run)["angle"]
    pushed = math.radians(5.0) * math.log(2.0)  # where 1 - exp(-x/reach) is half
    assert angle[np.searchsorted(run.time_s, 2.49)] == pytest.approx(pushed, rel=0.02)
    assert angle[-1] < 0.6 * pushed  # Dahl's loop closes on its own curve, not on the old place


def test_a_winding_heats_by_its_losses_and_keeps_its_heat_over_a_restart(motor_simulator):
    heat = {"resistance_rise_per_joule": 0.02, "thermal_time_constant_s": 30.0}
    plant = nxt(without=("inductance_h",), coulomb_friction_nm=2.0, effects={"winding_heating": heat})
    run = commanded([(0.0, 1.0)], seconds=10.0, every_s=0.05)

    def warming(_, x):
        current = NXT["supply_v"] / (NXT["resistance_ohm"] * (1.0 + x[0]))
        return [0.02 * NXT["supply_v"] * current - x[0] / 30.0]

    warm = solve_ivp(warming, (0.0, 10.0), [0.0], t_eval=run.time_s, rtol=1e-9).y[0]
    expected = NXT["supply_v"] / (NXT["resistance_ohm"] * (1.0 + warm))
    anew = np.isin(np.arange(run.time_s.size), [0, 100])
    start = Start(anew, np.zeros(run.time_s.size), np.zeros(run.time_s.size))
    for found in (
        motion(motor_simulator, plant, run)["current"][1:],
        motor_simulator.trace(plant, free_job(run, start))["current"][101:],
    ):
        np.testing.assert_allclose(found, expected[-found.size :], rtol=1e-3)
    assert expected[-1] < 0.7 * expected[0]


def cart(**effects):
    return plant_from_config({"kind": "rigid_body", "inertia": 2.0, "effects": effects}, "force_n")


def test_a_payload_is_there_from_its_time_on(linear_simulator):
    plant = cart(payload_inertia={"added_mass_kg": 3.0, "onset_s": 0.5003})
    run = commanded([(0.0, 4.0)], seconds=1.0, kind="force_n")
    speed = motion(linear_simulator, plant, run)["speed"]
    late = np.maximum(run.time_s - 0.5003, 0.0)
    np.testing.assert_allclose(speed, 2.0 * (run.time_s - late) + 0.8 * late, atol=1e-3)


def test_a_payload_s_time_runs_on_through_a_session(linear_simulator):
    plant = cart(payload_inertia={"added_mass_kg": 3.0, "onset_s": 1.5})
    run = commanded([(0.0, 4.0)], seconds=1.0, kind="force_n")
    ends = [motion(linear_simulator, plant, part)["speed"][-1] for part in in_session([run, run, run])]
    assert ends == pytest.approx([2.0, 1.0 + 0.4, 0.8], abs=5e-3)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_stop_throws_back_a_share_of_the_speed(linear_simulator, side):
    plant = cart(end_stop={"limit_m": 0.31 * side, "restitution": 0.5})
    run = commanded([(0.0, 0.0)], seconds=1.0, kind="force_n")
    found = motion(linear_simulator, plant, run, speed=2.0 * side)
    hit_s = 0.155
    expected = np.where(run.time_s < hit_s, 2.0 * run.time_s, 0.31 - (run.time_s - hit_s))
    np.testing.assert_allclose(found["angle"] * side, expected, atol=1e-9)
    assert found["speed"][-1] * side == pytest.approx(-1.0)


def test_a_run_that_begins_beyond_a_stop_stays_there(linear_simulator):
    plant = cart(end_stop={"limit_m": 0.2, "restitution": 0.0})
    run = commanded([(0.0, -1.0)], seconds=2.0, kind="force_n")
    found = motion(linear_simulator, plant, run, angle=0.5)
    assert found["angle"].min() == pytest.approx(0.2, abs=1e-6)
    assert abs(found["speed"][-1]) < 2e-3


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_stop_that_gives_swings_by_half_a_period_and_throws_back_a_share(linear_simulator, side):
    """The solution of a damped oscillator: while it touches, as the force is nothing again a little earlier."""
    mass, give = 2.0, 2e-3
    plant = cart(end_stop={"limit_m": 0.31 * side, "restitution": 0.5, "give_m_per_n": give})
    run = commanded([(0.0, 0.0)], seconds=1.0, kind="force_n")
    found = motion(linear_simulator, plant, run, speed=2.0 * side)
    damping = math.log(2.0) / math.hypot(math.pi, math.log(2.0))
    own = 1.0 / math.sqrt(mass * give)
    swing = own * math.sqrt(1.0 - damping**2)
    since_s = run.time_s - 0.155
    touching = (since_s > 0.0) & (since_s < 0.7 * math.pi / swing)
    pushed = 2.0 / swing * np.exp(-damping * own * since_s) * np.sin(swing * since_s)
    assert np.sum(touching) > 5
    np.testing.assert_allclose(found["angle"][touching] * side, 0.31 + pushed[touching], atol=1e-3)
    assert -found["speed"][-1] * side == pytest.approx(2.0 * 0.5, rel=0.15)


def test_a_stop_of_hardly_any_give_does_not_break_the_step(linear_simulator):
    plant = cart(end_stop={"limit_m": 0.31, "restitution": 0.0, "give_m_per_n": 1e-12})
    run = commanded([(0.0, 4.0)], seconds=2.0, kind="force_n")
    found = motion(linear_simulator, plant, run)
    assert found["angle"].max() < 0.312
    assert found["angle"][-1] == pytest.approx(0.31, abs=1e-4)


def test_a_fast_clock_stretches_the_motion(linear_simulator):
    skew = {"lag_span_s": 0.0, "rate_error": 0.25, "lag_period_s": 4.0, "lag_phase": 0.0}
    run = commanded([(0.0, 4.0)], seconds=1.0, kind="force_n")
    position = motion(linear_simulator, cart(clock_skew=skew), run)["predicted"]
    np.testing.assert_allclose(position, (run.time_s / 1.25) ** 2, rtol=1e-9, atol=1e-12)


def test_a_late_stamp_shows_where_the_body_was(linear_simulator):
    skew = {"lag_span_s": 0.08, "rate_error": 0.0, "lag_period_s": 0.7, "lag_phase": 0.5}
    run = commanded([(0.0, 0.0)], seconds=2.0, kind="force_n")
    shown = motion(linear_simulator, cart(clock_skew=skew), run, speed=3.0)["predicted"]
    lag_s = 0.08 * np.sin(np.pi * run.time_s / 0.7) ** 2
    np.testing.assert_allclose(shown, 3.0 * (run.time_s - lag_s), atol=1e-9)


def test_counts_are_lost_above_the_threshold_only(motor_simulator):
    missed = {"missed_counts": {"loss_fraction": 0.2, "speed_threshold_rad_s": 6.0}}
    run = commanded([(0.0, 1.0), (1.0, 0.3)], seconds=2.0)
    true = motion(motor_simulator, nxt(), run)
    shown = motion(motor_simulator, nxt(effects=missed), run)["predicted"]
    lost = np.diff(true["angle"] - shown)
    fast, slow = true["speed"][1:] > 7.0, true["speed"][1:] < 5.0
    moved = np.diff(true["angle"])
    steady = fast & (true["speed"][:-1] > 7.0)
    np.testing.assert_allclose(lost[steady], 0.2 * moved[steady], rtol=1e-6)
    calm = slow & (true["speed"][:-1] < 5.0)
    np.testing.assert_allclose(lost[calm], 0.0, atol=1e-9)
    assert steady.sum() > 50
    assert calm.sum() > 50


def test_an_eccentric_encoder_errs_with_the_angle_and_starts_where_it_shows(motor_simulator):
    off = {"amplitude_deg": 6.0, "cycles_per_turn": 2.0, "phase_deg": 50.0}
    run = commanded([(0.0, 0.8), (0.7, -0.5)], seconds=1.5)
    shown = motion(motor_simulator, nxt(effects={"encoder_eccentricity": off}), run)["predicted"]
    true = motion(motor_simulator, nxt(), run)["angle"]

    def encoder(angle):
        return angle + math.radians(6.0) * np.sin(2.0 * angle + math.radians(50.0))

    begin = 0.0
    for _ in range(100):
        begin -= encoder(begin)
    np.testing.assert_allclose(shown, encoder(true + begin), atol=2e-4)
    assert np.ptp(shown - true) > math.radians(10.0)


def test_an_eccentric_encoder_s_speed_is_the_slope_of_what_it_shows(motor_simulator):
    off = {"amplitude_deg": 6.0, "cycles_per_turn": 2.0, "phase_deg": 50.0}
    run = commanded([(0.0, 0.8)], seconds=1.0, every_s=1e-3)
    start = moving(run, speed=4.0)
    found = motor_simulator.trace(nxt(effects={"encoder_eccentricity": off}), free_job(run, start))
    np.testing.assert_allclose(found["speed"][1:-1], np.gradient(found["angle"], run.time_s)[1:-1], atol=0.05)
    assert found["angle"][0] == pytest.approx(0.0, abs=1e-5)
    assert found["speed"][0] == pytest.approx(4.0, abs=1e-3)
