import numpy as np
import pytest
from physics_samples import NXT, job_with_readings, rotary_plant, signals

from nxt_twin.physics.layout import layout
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.reference import predict
from nxt_twin.physics.simulate import Simulator, free_job
from nxt_twin.physics.start import at_rest
from nxt_twin.physics.stepper import Stepper

MOTOR = layout("dc_motor", "motor")
EFFECT_IDS = [effect.id for effect in MOTOR.effects if not effect.plain]


def with_effect(effect_id):
    plant = plant_from_config(NXT, "power_pct")
    effect = MOTOR.effect(effect_id)
    return plant.with_effect(effect_id, {p.symbol: p.starts[0] * p.si for p in effect.parameters})


@pytest.mark.parametrize("effect_id", ["none", *EFFECT_IDS])
def test_compiled_kernel_agrees_with_plain_python_in_free_run(motor_simulator, effect_id):
    plant = plant_from_config(NXT, "power_pct") if effect_id == "none" else with_effect(effect_id)
    run = signals(seconds=1.5)
    job = free_job(run, at_rest(run))
    compiled = motor_simulator.trace(plant, job)["predicted"]
    np.testing.assert_allclose(compiled, predict(plant, job)["predicted"], rtol=1e-9, atol=1e-9)
    assert np.ptp(compiled) > 1.0


@pytest.mark.parametrize("effect_id", ["none", *EFFECT_IDS])
def test_compiled_kernel_agrees_with_plain_python_when_corrected(motor_simulator, effect_id):
    plant = plant_from_config(NXT, "power_pct") if effect_id == "none" else with_effect(effect_id)
    job = job_with_readings(motor_simulator, seconds=1.0)
    compiled, plain = motor_simulator.trace(plant, job), predict(plant, job)
    for name in ("predicted", "weight", "cost"):
        np.testing.assert_allclose(compiled[name], plain[name], rtol=1e-8, atol=1e-8)


def test_a_plant_on_a_known_torque_agrees_with_plain_python(rotary_simulator):
    plant = rotary_plant()
    run = signals(seconds=2.0, kind="torque_nm", size=0.1)
    job = free_job(run, at_rest(run))
    compiled = rotary_simulator.trace(plant, job)["predicted"]
    np.testing.assert_allclose(compiled, predict(plant, job)["predicted"], rtol=1e-9, atol=1e-9)


def test_a_batch_on_several_threads_gives_what_its_members_give_alone(motor_simulator):
    plants = [with_effect(effect_id) for effect_id in EFFECT_IDS]
    run = signals(seconds=2.0)
    job = free_job(run, at_rest(run))
    vectors = [plant.vectors() for plant in plants]
    with Simulator(MOTOR, workers=3) as simulator:
        batch = simulator.run(np.array([v for v, _ in vectors]), np.array([a for _, a in vectors]), [job])
    for plant, predicted in zip(plants, batch[0].predicted, strict=True):
        np.testing.assert_array_equal(predicted, motor_simulator.trace(plant, job)["predicted"])


def test_stepping_from_outside_is_the_same_motion(motor_simulator):
    plant = with_effect("backlash")
    run = signals(seconds=1.0, regular=True)
    whole = motor_simulator.trace(plant, free_job(run, at_rest(run)))["predicted"]
    stepper = Stepper([plant, plant])
    stepped = []
    for t in np.arange(round(run.time_s[-1] * 1000) + 1) / 1000.0:
        if np.isclose(run.time_s, t, atol=1e-6).any():
            stepped.append(stepper.angle.copy())
        held = np.searchsorted(run.command_time_s, t + 1e-6) - 1
        stepper.step(np.full(2, run.command[held]), np.zeros(2, dtype=np.int64), NXT["supply_v"], 1e-3)
    np.testing.assert_allclose(np.array(stepped)[:, 0], whole, atol=1e-6)
    np.testing.assert_array_equal(np.array(stepped)[:, 0], np.array(stepped)[:, 1])
