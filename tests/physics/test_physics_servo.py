"""A motor that a loop of its own brings to a goal."""

import math

import numpy as np
import pytest
from physics_reference import predict
from physics_samples import NXT, commanded, motion, signals
from scipy.integrate import solve_ivp

from nxt_twin.errors import PlantError, RecordingError
from nxt_twin.physics.goals import follower
from nxt_twin.physics.modes import MODE_BRAKE, MODE_COAST, MODE_DRIVE
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.recorded import signals_of
from nxt_twin.physics.simulate import free_job
from nxt_twin.physics.start import at_rest
from nxt_twin.recording.recording import Recording

GAIN = 0.4  # % of duty for each degree
DEG = math.radians(1.0)


def servo(**changes):
    plain = {**NXT, "kind": "servo", "position_gain_pct_per_deg": GAIN}
    return plant_from_config({**plain, **changes}, "goal_position_rad")


def goals(*steps, seconds=1.5, mode=0):
    leaps = [(at, math.radians(goal)) for at, goal in steps]
    return commanded(leaps, seconds=seconds, kind="goal_position_rad", mode=mode)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {
            "derivative_gain_pct_s_per_deg": 0.02,
            "power_limit_pct": 60.0,
            "dead_band_deg": 2.0,
            "goal_delay_s": 0.03,
        },
        {"goal_rate_limit_deg_per_s": 200.0, "integral_rate_per_s": 2.0},
        {"effects": {"power_limit": {"limit_pct": 35.0}, "loop_dead_band": {"width_deg": 4.0}}},
        {
            "effects": {
                "gravity_load": {"gravity_torque_nm": 0.05, "phase_deg": 20.0},
                "command_delay": {"delay_s": 0.02},
            }
        },
    ],
)
def test_the_compiled_loop_agrees_with_plain_python(servo_simulator, changes):
    run = signals(seconds=1.0, kind="goal_position_rad", size=2.0)
    job = free_job(run, at_rest(run))
    compiled = servo_simulator.trace(servo(**changes), job)["predicted"]
    np.testing.assert_allclose(compiled, predict(servo(**changes), job)["predicted"], rtol=1e-9, atol=1e-9)
    assert np.ptp(compiled) > 0.3


def test_a_proportional_loop_moves_as_its_equations_say(servo_simulator):
    gain, damping, goal = 0.8, 0.02, 0.9

    def law(_, state):
        angle, speed = state
        pct = gain * math.degrees(goal - angle) - damping * math.degrees(speed)
        duty = min(max(0.01 * pct, -0.5), 0.5)
        torque = NXT["torque_constant_nm_per_a"] * (duty * 8.0 - 0.4908 * speed) / NXT["resistance_ohm"]
        return speed, (torque - NXT["viscous_friction_nm_s_per_rad"] * speed) / NXT["inertia_kg_m2"]

    bare = {"coulomb_friction_nm": 0.0, "inductance_h": 0.0}
    plant = servo(
        position_gain_pct_per_deg=gain, derivative_gain_pct_s_per_deg=damping, power_limit_pct=50.0, **bare
    )
    found = motion(servo_simulator, plant, goals((0.0, math.degrees(goal))))["angle"]
    expected = solve_ivp(law, (0.0, 1.5), (0.0, 0.0), t_eval=0.01 * np.arange(151), rtol=1e-8, max_step=2e-3)
    np.testing.assert_allclose(found, expected.y[0], atol=0.2 * DEG)


def test_an_integral_a_dead_band_a_delay_and_a_rate_limit_are_those_of_another_simulator(servo_simulator):
    gain, integral, dead_deg, delay_s, rate_deg_s, goal_deg = 0.6, 1.5, 1.0, 0.03, 250.0, 80.0

    def law(time_s, state):
        angle, speed, total = state
        goal = min(max(time_s - delay_s, 0.0) * rate_deg_s, goal_deg)
        error = goal + integral * total - math.degrees(angle)
        pct = gain * error if abs(error) > dead_deg else 0.0
        torque = NXT["torque_constant_nm_per_a"] * (0.01 * pct * 8.0 - 0.4908 * speed) / NXT["resistance_ohm"]
        moves = (torque - NXT["viscous_friction_nm_s_per_rad"] * speed) / NXT["inertia_kg_m2"]
        sums = goal_deg if time_s >= delay_s else 0.0
        return speed, moves, sums - math.degrees(angle)

    plant = servo(
        position_gain_pct_per_deg=gain,
        integral_rate_per_s=integral,
        dead_band_deg=dead_deg,
        goal_delay_s=delay_s,
        goal_rate_limit_deg_per_s=rate_deg_s,
        coulomb_friction_nm=0.0,
        inductance_h=0.0,
    )
    found = motion(servo_simulator, plant, goals((0.0, goal_deg), seconds=0.6))["angle"]
    grid = 0.01 * np.arange(61)
    expected = solve_ivp(law, (0.0, 0.6), (0.0, 0.0, 0.0), t_eval=grid, rtol=1e-8, max_step=1e-3)
    np.testing.assert_allclose(found, expected.y[0], atol=0.3 * DEG)
    assert expected.y[0].max() > 0.9


def test_an_error_within_the_dead_band_moves_nothing_and_coasting_neither(servo_simulator):
    quiet = motion(servo_simulator, servo(dead_band_deg=5.0), goals((0.0, 4.9)))["angle"]
    loose = motion(servo_simulator, servo(), goals((0.0, 90.0), mode=MODE_COAST))["angle"]
    np.testing.assert_array_equal(quiet, 0.0)
    np.testing.assert_array_equal(loose, 0.0)


def test_a_power_limit_clips_the_loop_s_duty_below_what_the_plant_states(servo_simulator):
    run = goals((0.0, 300.0))
    limited = {"effects": {"power_limit": {"limit_pct": 40.0}}}
    found = motion(servo_simulator, servo(**limited), run)
    stated = motion(servo_simulator, servo(power_limit_pct=40.0), run)
    assert np.abs(found["duty"]).max() == pytest.approx(0.4)
    np.testing.assert_allclose(found["angle"], stated["angle"], atol=1e-12)
    lower = motion(servo_simulator, servo(power_limit_pct=25.0, **limited), run)
    assert np.abs(lower["duty"]).max() == pytest.approx(0.25)


def test_a_power_limit_bounds_the_speed_and_one_of_the_current_only_its_growth(servo_simulator):
    run = goals((0.0, 2000.0), seconds=3.0)
    half, current = (
        motion(servo_simulator, servo(coulomb_friction_nm=0.0, **changes), run)["speed"]
        for changes in ({"effects": {"power_limit": {"limit_pct": 50.0}}}, {"current_limit_a": 0.5})
    )
    free = motion(servo_simulator, servo(coulomb_friction_nm=0.0), run)["speed"]
    assert half[100] == pytest.approx(0.5 * free[100], rel=0.01)
    assert current[100] == pytest.approx(free[100], rel=0.01)
    # At rest 8 V over 7.6 Ω drive 1.05 A: half a volt's worth and half an ampere's begin nearly alike.
    assert half[2] == pytest.approx(current[2], rel=0.2)


def test_a_power_limit_of_100_percent_does_nothing(servo_simulator):
    run = goals((0.0, 300.0), (0.7, -200.0))
    plain, limited = (
        motion(servo_simulator, servo(**changes), run)["angle"]
        for changes in ({}, {"effects": {"power_limit": {"limit_pct": 100.0}}})
    )
    np.testing.assert_array_equal(plain, limited)


def test_a_loop_s_dead_band_is_that_of_the_plant_file_wherever_it_is_written(servo_simulator):
    run = goals((0.0, 60.0), (0.7, 58.5), (1.0, -30.0))
    added = motion(servo_simulator, servo(effects={"loop_dead_band": {"width_deg": 12.0}}), run)["angle"]
    stated = motion(servo_simulator, servo(dead_band_deg=12.0), run)["angle"]
    np.testing.assert_allclose(added, stated, atol=1e-12)
    none = motion(servo_simulator, servo(), run)["angle"]
    assert np.abs(added - none).max() > 0.5 * DEG


def test_the_wider_of_two_dead_bands_holds(servo_simulator):
    narrow = servo(dead_band_deg=5.0, effects={"loop_dead_band": {"width_deg": 1.0}})
    np.testing.assert_array_equal(motion(servo_simulator, narrow, goals((0.0, 4.0)))["angle"], 0.0)


def test_the_firmware_s_regulator_takes_the_place_of_the_loop_with_all_that_is_in_it():
    regulated = servo(regulation_p=96)
    gone = {"power_limit", "loop_dead_band", "integral_action", "goal_rate_limit"}
    assert set(regulated.layout.effect("firmware_regulation").supersedes) == gone


def test_a_goal_delay_moves_the_response_by_exactly_that_much(servo_simulator):
    run = goals((0.0, 0.0), (0.1, 60.0))
    prompt, late = (motion(servo_simulator, servo(goal_delay_s=s), run)["angle"] for s in (0.0, 0.05))
    np.testing.assert_allclose(late[5:], prompt[:-5], rtol=1e-9, atol=1e-9)


def test_a_loop_holds_what_it_stands_at_until_its_first_goal_acts(servo_simulator):
    delayed = servo(goal_delay_s=0.1, effects={"command_delay": {"delay_s": 0.05}}, integral_rate_per_s=2.0)
    found = motion(servo_simulator, delayed, goals((0.0, 130.0)), angle=90.0 * DEG)["angle"]
    np.testing.assert_array_equal(found[:16], 90.0 * DEG)
    assert found[18] > 90.0 * DEG
    assert found[-1] == pytest.approx(130.0 * DEG, abs=10.0 * DEG)


def test_a_loop_comes_to_rest_where_the_goal_and_its_offset_are(servo_simulator):
    frictionless = servo(coulomb_friction_nm=0.0, goal_offset_deg=-0.5)
    found = motion(servo_simulator, frictionless, goals((0.0, 60.0), seconds=4.0))["angle"]
    assert found[-1] == pytest.approx(59.5 * DEG, abs=0.01 * DEG)


def test_friction_leaves_an_error_standing_that_an_integral_wears_away(servo_simulator):
    run = goals((0.0, 30.0), seconds=6.0)
    loop = {"coulomb_friction_nm": 0.08}
    stands, wears = (
        motion(servo_simulator, servo(**loop, **more), run)["angle"][-1]
        for more in ({}, {"integral_rate_per_s": 2.0})
    )
    assert abs(stands - 30.0 * DEG) > 3.0 * DEG
    assert abs(wears - 30.0 * DEG) < 0.5 * abs(stands - 30.0 * DEG)


def test_a_goal_s_rate_limit_bounds_the_speed_and_begins_where_the_motor_is(servo_simulator):
    plant = servo(goal_rate_limit_deg_per_s=90.0)
    found = motion(servo_simulator, plant, goals((0.0, 120.0)), angle=60.0 * DEG)
    assert found["speed"].max() == pytest.approx(90.0 * DEG, rel=0.25)
    assert found["angle"][0] == 60.0 * DEG
    assert np.all(np.diff(found["angle"]) > -1e-9)


def test_a_goal_drives_servos_only_and_servos_are_driven_by_goals_only():
    with pytest.raises(PlantError, match="a dc_motor is not driven by goal_position_rad"):
        plant_from_config(NXT, "goal_position_rad")
    with pytest.raises(PlantError, match="a servo is not driven by power_pct"):
        plant_from_config({**NXT, "kind": "servo", "position_gain_pct_per_deg": 1.0}, "power_pct")
    with pytest.raises(PlantError, match="position_gain_pct_per_deg: is missing"):
        plant_from_config({**NXT, "kind": "servo"}, "goal_position_rad")


def brick(**columns):
    time_s = 0.01 * np.arange(100)
    return Recording("run", {"time_s": time_s, "a_tacho_deg": np.arange(100.0), **columns})


def test_a_recorded_goal_drives_where_no_power_is_recorded_or_a_servo_asks_for_it():
    goal = np.where(np.arange(100) < 50, 10.0, 40.0)
    alone = signals_of(brick(a_goal_deg=goal), "a")
    assert alone.input_kind == "goal_position_rad"
    np.testing.assert_allclose(np.degrees(alone.command), [10.0, 40.0])
    both = brick(a_goal_deg=goal, a_power_pct=np.zeros(100))
    assert signals_of(both, "a").input_kind == "power_pct"
    assert signals_of(both, "a", follows_goal=True).input_kind == "goal_position_rad"


def test_a_regulated_speed_is_a_setpoint_that_moves_whenever_the_regulator_runs():
    power = np.where(np.arange(100) < 20, 0.0, 30.0)
    power[70:] = -10.0
    power[90:] = 0.0
    signals = signals_of(brick(a_power_pct=power, a_regulation=np.ones(100)), "a")
    assert signals.input_kind == "goal_position_rad"
    at = np.searchsorted(signals.command_time_s, 0.01 * np.arange(100), side="right") - 1
    goal = np.degrees(signals.command[at])
    runs = 20 + np.array([11, 21, 51, 61])  # just after the regulator has run, at 0.2 + 0.101 n
    np.testing.assert_allclose(goal[runs], [50.0, 80.0, 130.0, 120.0])
    assert goal[95] == pytest.approx(90.0)  # held where the motor was when it was told to stop
    np.testing.assert_array_equal(signals.command_mode[at][90:], MODE_BRAKE)
    np.testing.assert_array_equal(signals.command_mode[at][31:90], MODE_DRIVE)
    mixed = brick(a_power_pct=np.full(100, 30.0), a_regulation=(power != 0.0).astype(float))
    with pytest.raises(RecordingError, match="split the recording where the regulation is switched"):
        signals_of(mixed, "a")


def test_the_firmware_s_regulator_agrees_with_plain_python_and_with_its_own_formula(servo_simulator):
    plant = plant_from_config(
        {**NXT, "kind": "servo", "position_gain_pct_per_deg": 0.0, "regulation_p": 96}, "goal_position_rad"
    )
    run = commanded(
        [(0.1 * n, math.radians(6.0 * n)) for n in range(10)], seconds=1.0, kind="goal_position_rad"
    )
    job = free_job(run, at_rest(run))
    compiled = servo_simulator.trace(plant, job)
    np.testing.assert_allclose(compiled["predicted"], predict(plant, job)["predicted"], rtol=1e-9, atol=1e-9)
    errors, total, duty = [0.0], 0.0, [0.0]
    for n in range(1, 10):
        errors.append(6.0 * n - math.degrees(compiled["angle"][10 * n]))
        total = 0.25 * (3.0 * total + errors[-1])
        duty.append(0.5 * (3.0 * errors[-1] + total + errors[-1] - errors[-2]) / 100.0)
    np.testing.assert_allclose(compiled["duty"][5::10], duty, atol=1e-6)


def test_a_motor_on_a_regulated_recording_gets_the_firmware_s_regulator():
    recording = brick(a_power_pct=np.full(100, 30.0), a_regulation=np.ones(100))
    config = follower({**NXT, "kind": "dc_motor"}, [recording], "a")
    assert (config["kind"], config["regulation_p"], config["position_gain_pct_per_deg"]) == (
        "servo",
        96.0,
        0.0,
    )
    own = follower({**config, "regulation_p": 64.0}, [recording], "a")
    assert own["regulation_p"] == 64.0
    assert follower(NXT, [brick(a_power_pct=np.full(100, 30.0))], "a") is NXT
