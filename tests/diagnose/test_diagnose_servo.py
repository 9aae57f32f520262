"""A servo's case from end to end, and the firmware's regulated mode beside a mock brick."""

import numpy as np
import pytest
import yaml

from firmware_protocol import MotorMode, RegulationMode
from nxt_twin.api.openers import OPENERS
from nxt_twin.api.prediction import predictions, simulate
from nxt_twin.brick.open import open_brick
from nxt_twin.diagnose.engine import diagnose, fit_as_it_stands
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.recording.case import case_of
from nxt_twin.recording.columns import REGULATIONS
from nxt_twin.recording.recording import Recording

MOTOR = {
    "resistance_ohm": 7.6,
    "torque_constant_nm_per_a": 0.4908,
    "back_emf_v_s_per_rad": 0.4908,
    "coulomb_friction_nm": 8.45e-3,
    "viscous_friction_nm_s_per_rad": 1.92e-3,
    "inertia_kg_m2": 1.2e-3,
    "supply_v": 8.0,
}


def test_a_loop_s_gain_is_fitted_from_goal_and_reading_alone():
    rng = np.random.default_rng(5)
    time_s = 0.01 * np.arange(800)
    goal = np.repeat(rng.uniform(-150.0, 150.0, 10).round(1), 80)
    baseline = {**MOTOR, "kind": "servo", "position_gain_pct_per_deg": 0.9}
    truth = {**baseline, "position_gain_pct_per_deg": 0.6}
    run = simulate(truth, Recording("run", {"time_s": time_s, "a_goal_deg": goal}))
    read = np.round(run.columns["a_tacho_deg"] / 0.088) * 0.088
    seen = Recording("run", {**run.columns, "a_tacho_deg": read}, tacho_step_deg={"a": 0.088})
    fitted = fit_as_it_stands(case_of([seen], baseline)).plant
    gain = Slot(BASE_OWNER, "position_gain")
    assert fitted.values[gain] / fitted.layout.parameters[gain].si == pytest.approx(0.6, rel=0.05)
    for frozen in ("dead_band", "power_limit", "derivative_gain", "goal_delay"):
        slot = Slot(BASE_OWNER, frozen)
        assert fitted.values[slot] == (1.0 if frozen == "power_limit" else 0.0)


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
