"""A servo's case from end to end, and the firmware's regulated mode beside a mock brick."""

import math
from dataclasses import replace

import numpy as np
import pytest
import yaml
from scipy.integrate import solve_ivp

from firmware_protocol import MotorMode, RegulationMode
from nxt_twin.api.openers import OPENERS
from nxt_twin.api.prediction import predictions
from nxt_twin.brick.open import open_brick
from nxt_twin.diagnose.changed.compare import changed
from nxt_twin.diagnose.engine import diagnose, fit_as_it_stands
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.recording.case import case_of
from nxt_twin.recording.columns import REGULATIONS
from nxt_twin.recording.recording import Recording

pytestmark = pytest.mark.usefixtures("one_by_one")

MOTOR = {
    "resistance_ohm": 7.6,
    "torque_constant_nm_per_a": 0.4908,
    "back_emf_v_s_per_rad": 0.4908,
    "coulomb_friction_nm": 8.45e-3,
    "viscous_friction_nm_s_per_rad": 1.92e-3,
    "inertia_kg_m2": 1.2e-3,
    "supply_v": 8.0,
}


def followed(time_s, goal, gain, damping, limit_pct=100.0, band_deg=0.0):
    """The angle, deg, of a servo that another simulator moves: a loop on the angle, and friction that is smooth."""

    def law(_, state, aim):
        angle, speed = state
        error = math.degrees(aim - angle)
        pct = gain * (error if abs(error) > band_deg else 0.0) - damping * math.degrees(speed)
        volts = 0.08 * min(max(pct, -limit_pct), limit_pct)
        torque = MOTOR["torque_constant_nm_per_a"] * (volts - 0.4908 * speed) / MOTOR["resistance_ohm"]
        torque -= 1.92e-3 * speed + 8.45e-3 * math.tanh(speed / 0.02)
        return speed, torque / MOTOR["inertia_kg_m2"]

    state, found = (0.0, 0.0), [0.0]
    for start, end, aim in zip(time_s[:-1], time_s[1:], np.radians(goal), strict=False):
        state = solve_ivp(law, (start, end), state, args=(aim,), method="LSODA", rtol=1e-6, atol=1e-8).y[
            :, -1
        ]
        found.append(math.degrees(state[0]))
    return np.array(found)


def damping_of(config):
    """Torque per speed over inertia, 1/s."""
    volts = 0.08 * math.degrees(config["derivative_gain_pct_s_per_deg"]) + config["back_emf_v_s_per_rad"]
    by_current = config["torque_constant_nm_per_a"] / config["resistance_ohm"] * volts
    return (by_current + config["viscous_friction_nm_s_per_rad"]) / config["inertia_kg_m2"]


@pytest.mark.parametrize(("rounded", "offset_deg"), [(np.floor, -0.5), (np.round, 0.0), (np.ceil, 0.5)])
def test_how_an_encoder_rounds_is_found_and_named_as_no_effect(rounded, offset_deg):
    rng = np.random.default_rng(7)
    runs = []
    for name in ("one", "two", "three"):
        time_s = 0.01 * np.arange(500)
        goal = np.repeat(rng.uniform(-120.0, 120.0, 10).round(1), 50)
        columns = {
            "time_s": time_s,
            "a_goal_deg": goal,
            "a_tacho_deg": rounded(followed(time_s, goal, 2.0, 0.02)),
        }
        runs.append(Recording(name, columns, tacho_step_deg={"a": 1.0}))
    loop = {"position_gain_pct_per_deg": 1.8, "derivative_gain_pct_s_per_deg": 0.022}
    found = diagnose(case_of(runs, {**MOTOR, "kind": "servo", **loop})).diagnosis
    assert (found.verdict, found.effects) == ("adequate", ())
    assert found.refit["goal_offset_deg"].after == pytest.approx(offset_deg, abs=0.15)


def test_a_loop_s_gains_are_fitted_from_goal_and_reading_alone_where_they_are_30_percent_off():
    rng = np.random.default_rng(5)
    time_s, steps = 0.01 * np.arange(500), rng.uniform(-120.0, 120.0, 10).round(1)
    goal = np.repeat(steps, 50)
    read = np.round(followed(time_s, goal, 2.0, 0.02) / 0.088) * 0.088
    columns = {"time_s": time_s, "a_goal_deg": goal, "a_tacho_deg": read}
    seen = Recording("run", columns, tacho_step_deg={"a": 0.088})
    loop = {"position_gain_pct_per_deg": 1.4, "derivative_gain_pct_s_per_deg": 0.026}
    fitted = fit_as_it_stands(case_of([seen], {**MOTOR, "kind": "servo", **loop})).plant
    config = fitted.to_config()
    assert config["position_gain_pct_per_deg"] == pytest.approx(2.0, rel=0.05)
    # Below full duty, damping by the loop, the back-EMF and friction are one torque per speed: their sum is known.
    assert damping_of(config) == pytest.approx(
        damping_of({**MOTOR, "derivative_gain_pct_s_per_deg": 0.02}), rel=0.1
    )
    frozen = {"dead_band_deg": 0.0, "power_limit_pct": 100.0, "goal_delay_s": 0.0}
    assert {name: config[name] for name in frozen} == frozen


def loop_case(gain=2.0, damping=0.02, **loop):
    """A case of a servo whose loop has more than its plant file says, with three recordings."""
    rng = np.random.default_rng(11)
    runs = []
    for name in ("one", "two", "three"):
        time_s = 0.01 * np.arange(600)
        goal = np.repeat([0.0, *np.cumsum(rng.uniform(-60.0, 60.0, 19)).round(1)], 30)
        read = np.round(followed(time_s, goal, gain, damping, **loop) / 0.088) * 0.088
        columns = {"time_s": time_s, "a_goal_deg": goal, "a_tacho_deg": read}
        runs.append(Recording(name, columns, tacho_step_deg={"a": 0.088}))
    gains = {"position_gain_pct_per_deg": 0.9 * gain, "derivative_gain_pct_s_per_deg": 1.1 * damping}
    return case_of(runs, {**MOTOR, "kind": "servo", **gains})


@pytest.mark.parametrize(
    ("loop", "effect_id", "name", "value"),
    [
        ({"limit_pct": 45.0}, "power_limit", "limit_pct", 45.0),
        ({"band_deg": 3.0}, "loop_dead_band", "width_deg", 3.0),
    ],
)
def test_a_power_limit_or_a_dead_band_that_a_servo_s_plant_file_lacks_is_named(loop, effect_id, name, value):
    found = diagnose(loop_case(**loop)).diagnosis
    assert (found.verdict, [effect.id for effect in found.effects]) == ("explained", [effect_id])
    assert found.effects[0].params[name].value == pytest.approx(value, rel=0.05)


def test_a_limit_is_named_though_another_motor_behind_a_stiffer_loop_would_move_alike():
    """At 45 % of its duty a motor moves as one with 2.2 times its constants and 4.9 times its inertia at all of it.

    No reading tells the two apart. Of the given numbers, 2.2 times the torque constant is 5 standard deviations.
    """
    found = diagnose(loop_case(gain=8.0, damping=0.0, limit_pct=45.0)).diagnosis
    assert (found.verdict, [effect.id for effect in found.effects]) == ("explained", ["power_limit"])
    assert found.effects[0].params["limit_pct"].value == pytest.approx(45.0, rel=0.1)
    assert found.refit["torque_constant_nm_per_a"].after == pytest.approx(0.4908, rel=0.1)


def test_a_servo_without_either_gets_no_name_and_is_told_from_which_size_it_would_have():
    found = diagnose(loop_case()).diagnosis
    assert (found.verdict, found.effects) == ("adequate", ())
    sizes = {one.id: one for one in found.detectable}
    limit, band = sizes["power_limit"], sizes["loop_dead_band"]
    assert not limit.seen_above
    assert 60.0 < limit.size < 100.0
    assert band.seen_above
    assert 0.0 < band.size < 2.0


@pytest.mark.slow_variants
@pytest.mark.parametrize(
    ("after", "of", "value", "words"),
    [
        ({"limit_pct": 45.0}, "power_limit", 45.0, "power limit of the loop is new (limit 4"),
        ({"band_deg": 3.0}, "loop_dead_band", 3.0, "loop dead band is new (width "),
        ({"gain": 1.4}, "position_gain_pct_per_deg", 1.4, "position gain "),
    ],
    ids=["limit", "dead band", "gain"],
)
def test_what_somebody_set_in_a_servo_s_loop_is_named_as_its_loop_s(after, of, value, words):
    (found,) = changed(loop_case(), [replace(loop_case(**after), name="after")])
    (change,) = found.changes
    assert change.of == of
    assert change.after == pytest.approx(value, rel=0.05)
    assert found.sentence.startswith(f"The servo's loop changed: {words}")
    assert "The motor and its load did not change." in found.sentence


@pytest.fixture(scope="module")
def regulated(tmp_path_factory):
    """Records motor A of a mock, with these effects, at speeds that its firmware regulates."""
    folder = tmp_path_factory.mktemp("regulated")

    def record(effects):
        world = folder / "world.yaml"
        world.write_text(yaml.safe_dump({"motors": {"a": {**MOTOR, "kind": "dc_motor", "effects": effects}}}))
        clock, rows = VirtualClock(), []
        with open_brick(f"mock:?world={world}", clock, OPENERS) as brick:
            for power_pct in (45, -30, 60, 0, 75, -70, 20, -50, 35):
                mode = MotorMode.ON | MotorMode.BRAKE | MotorMode.REGULATED
                brick.motors.set_output_state(
                    0, power_pct=power_pct, mode=mode, regulation=RegulationMode.SPEED
                )
                for _ in range(100):
                    rows.append((clock.now_s(), power_pct, brick.motors.tacho_deg(0).value))
                    clock.sleep(0.009)
        time_s, power, tacho = np.array(rows, dtype=float).T
        speed = np.full(time_s.size, float(REGULATIONS.index("speed")))
        columns = {"time_s": time_s, "a_power_pct": power, "a_regulation": speed, "a_tacho_deg": tacho}
        return Recording("run", columns)

    return record


def test_a_regulated_motor_is_predicted_from_its_set_speeds_alone(regulated):
    run = regulated({})
    (found,) = predictions({**MOTOR, "kind": "dc_motor"}, run)
    assert np.ptp(run.columns["a_tacho_deg"]) > 500.0
    assert found.rmse < 4.0  # a setpoint that missed one period at each change would be 75 deg off


def test_what_a_regulated_motor_s_model_leaves_out_is_named(regulated):
    run = regulated({"constant_load": {"load_torque_nm": 0.04}})
    found = diagnose(case_of([run], {**MOTOR, "kind": "dc_motor"})).diagnosis
    assert (found.verdict, [effect.id for effect in found.effects]) == ("explained", ["constant_load"])
    assert found.effects[0].params["load_torque_nm"].value == pytest.approx(0.04, rel=0.1)
