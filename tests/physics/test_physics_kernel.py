from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from physics_reference import predict
from physics_samples import NXT, job_with_readings, signals

from nxt_twin.errors import PlantError
from nxt_twin.physics import stepper as stepper_module
from nxt_twin.physics.layout import layout
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.simulate import Simulator, free_job
from nxt_twin.physics.start import at_rest, restarts
from nxt_twin.physics.stepper import Stepper

MOTOR = layout("dc_motor", "motor")
EFFECT_IDS = [effect.id for effect in MOTOR.effects if not effect.plain]


def with_effect(effect_id, **values):
    plant = plant_from_config(NXT, "power_pct")
    effect = MOTOR.effect(effect_id)
    return plant.with_effect(effect_id, {p.symbol: p.starts[0] * p.si for p in effect.parameters} | values)


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


@pytest.mark.parametrize("effect_id", ["none", *EFFECT_IDS])
def test_a_run_started_anew_from_all_that_it_had_reached_is_the_same_run(motor_simulator, effect_id):
    plant = plant_from_config(NXT, "power_pct") if effect_id == "none" else with_effect(effect_id)
    run = signals(seconds=1.5)
    whole = free_job(run, at_rest(run))
    anew = np.arange(run.time_s.size) % 25 == 0
    again = free_job(run, motor_simulator.reached(plant, whole, anew))
    assert again.start.states.shape[0] == anew.sum() > 5
    before, after = (motor_simulator.trace(plant, job)["predicted"] for job in (whole, again))
    np.testing.assert_allclose(after, before, atol=1e-6)
    np.testing.assert_allclose(after, predict(plant, again)["predicted"], rtol=1e-9, atol=1e-9)


def test_each_set_of_a_batch_starts_from_its_own_states_as_it_does_alone(motor_simulator):
    plants = [with_effect(effect_id) for effect_id in ("shaft_compliance", "backlash", "presliding") * 2]
    values, active = (np.array(part) for part in zip(*(plant.vectors() for plant in plants), strict=True))
    runs = [free_job(run, at_rest(run)) for run in (signals(seconds=1.0), signals(seconds=1.5, size=60.0))]
    anew = [np.arange(run.signals.time_s.size) % 25 == 0 for run in runs]
    with Simulator(MOTOR, workers=3) as simulator:
        starts = simulator.reached_by(values, active, runs, anew)
        jobs = [[replace(run, start=one) for one in own] for run, own in zip(runs, starts, strict=True)]
        found = simulator.run_own(values, active, jobs)
    for n, plant in enumerate(plants):
        for run, at, own, result in zip(runs, anew, jobs, found, strict=True):
            np.testing.assert_array_equal(own[n].start.states, motor_simulator.reached(plant, run, at).states)
            alone = motor_simulator.trace(plant, own[n])["predicted"]
            np.testing.assert_allclose(result.predicted[n], alone, rtol=1e-12, atol=1e-12)


def test_part_of_a_start_keeps_its_states(motor_simulator):
    run = signals(seconds=1.0)
    anew = np.arange(run.time_s.size) % 10 == 0
    start = motor_simulator.reached(with_effect("shaft_compliance"), free_job(run, at_rest(run)), anew)
    rows = np.flatnonzero(np.arange(run.time_s.size) % 20 < 3)
    np.testing.assert_array_equal(start.part(rows).states, start.states[::2])


def body(kind, effect_id):
    """A body with friction on a known torque or force, with one effect at NXT scale."""
    config = {"kind": "rigid_body", "inertia": 2e-3, "viscous_friction": 5e-3, "coulomb_friction": 0.02}
    plant = plant_from_config(config, kind)
    if effect_id == "none":
        return plant
    parameters = [p.in_frame(plant.layout.frame) for p in plant.layout.effect(effect_id).parameters]
    return plant.with_effect(effect_id, {p.symbol: p.starts[0] * p.si for p in parameters})


def nested(frame):
    return ["none", *(e.id for e in layout("rigid_body", frame).effects if not e.plain)]


@pytest.mark.parametrize("effect_id", nested("rotary"))
def test_a_plant_on_a_known_torque_agrees_with_plain_python(rotary_simulator, effect_id):
    plant = body("torque_nm", effect_id)
    run = signals(seconds=1.0, kind="torque_nm", size=0.1)
    job = free_job(run, at_rest(run))
    compiled = rotary_simulator.trace(plant, job)["predicted"]
    np.testing.assert_allclose(compiled, predict(plant, job)["predicted"], rtol=1e-9, atol=1e-9)


def test_readings_whose_ages_are_known_agree_with_plain_python(motor_simulator):
    job = job_with_readings(motor_simulator, seconds=2.0)
    rows = job.signals.time_s.size
    shown_s = 0.01 * (np.arange(rows) % 5)
    ages = np.column_stack([shown_s, np.where(shown_s > 0.0, 0.012, -1.0), np.zeros((rows, 2))])
    known = replace(job.signals, ages=ages)
    plant, job = with_effect("sample_hold"), replace(job, signals=known)
    compiled, plain = motor_simulator.trace(plant, job), predict(plant, job)
    for name in ("predicted", "weight", "cost"):
        np.testing.assert_allclose(compiled[name], plain[name], rtol=1e-9, atol=1e-9)


def test_rows_that_are_late_by_chance_agree_with_plain_python(motor_simulator):
    job = job_with_readings(motor_simulator, seconds=2.0)
    late = 0.5 * np.sin(7.0 * np.arange(job.signals.time_s.size))
    known = replace(
        job.signals,
        ages=np.column_stack([np.full((late.size, 2), -1.0), late, np.full(late.size, 0.2)]),
        command_late=0.5 * np.cos(5.0 * np.arange(job.signals.command_time_s.size)),
    )
    plant = with_effect("clock_skew", lag_span=0.03, waves=0.0, of_commands=1.0)
    job = replace(job, signals=known)
    compiled, plain = motor_simulator.trace(plant, job), predict(plant, job)
    for name in ("predicted", "weight", "cost"):
        np.testing.assert_allclose(compiled[name], plain[name], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("effect_id", nested("linear"))
def test_a_plant_on_a_known_force_read_as_speed_agrees_with_plain_python(linear_simulator, effect_id):
    plant = body("force_n", effect_id)
    run = replace(signals(seconds=1.0, kind="force_n", size=0.1), is_speed=True)
    start = restarts(replace(run, measured=np.zeros(run.time_s.size)), 0.4)
    job = free_job(run, start)
    compiled = linear_simulator.trace(plant, job)["predicted"]
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


STEPPED = [
    effect_id for effect_id in EFFECT_IDS if effect_id not in {"clock_skew", "sample_hold", "stale_samples"}
]


@pytest.mark.parametrize("effect_id", STEPPED)
def test_stepping_from_outside_is_the_same_motion(motor_simulator, effect_id):
    plant = with_effect(effect_id)
    run = signals(seconds=1.0, regular=True)
    whole = motor_simulator.trace(plant, free_job(run, at_rest(run)))
    stepper = Stepper([plant, plant])
    shift = whole["predicted"][0] - stepper.shown[0]
    shown = []
    for t in np.arange(round(run.time_s[-1] * 1000) + 1) / 1000.0:
        if np.isclose(run.time_s, t, atol=1e-6).any():
            shown.append(stepper.shown.copy())
        held = np.searchsorted(run.command_time_s, t + 1e-6) - 1
        stepper.step(np.full(2, run.command[held]), np.zeros(2, dtype=np.int64), NXT["supply_v"], 1e-3)
    if (
        effect_id == "encoder_eccentricity"
    ):  # a stepper begins at hub angle 0, a run where the encoder shows 0
        assert shift == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(np.array(shown)[:, 0] + shift, whole["predicted"], atol=1e-6)
    np.testing.assert_array_equal(np.array(shown)[:, 0], np.array(shown)[:, 1])


@pytest.mark.parametrize("effects", [{}, {"constant_load": {"load_torque_nm": 0.02}}])
def test_a_stepper_that_is_not_ready_moves_as_one_that_is(effects):
    plant = plant_from_config({**NXT, "effects": effects}, "power_pct")
    ready, waiting = Stepper([plant]), Stepper([plant], ready=False)
    for duty in [0.0] * 30 + [0.5] * 30 + [0.0] * 30:
        for stepper in (ready, waiting):
            stepper.step(np.array([duty]), np.zeros(1, dtype=np.int64), 8.0, 1e-3)
        np.testing.assert_array_equal(waiting.shown, ready.shown)
    assert abs(ready.angle[0]) > 0.01


def test_a_stepper_takes_plants_of_one_kind():
    motor = plant_from_config(NXT, "power_pct")
    for plants in ([], [motor, plant_from_config({"kind": "rigid_body", "inertia": 1e-3}, "torque_nm")]):
        with pytest.raises(PlantError, match="plants of one kind"):
            Stepper(plants)


def test_each_plant_of_a_stepper_has_its_own_state():
    stepper = Stepper([plant_from_config(NXT, "power_pct")] * 2, ready=False)
    for number in range(50):
        stepper.step(np.array([0.0, 0.5]), np.zeros(2, dtype=np.int64), 8.0, 1e-3)
        if number == 0:
            assert stepper.speed[1] > 0.0
    assert (stepper.angle[0], stepper.speed[0], stepper.current[0]) == (0.0, 0.0, 0.0)
    assert stepper.speed[1] > 1.0
    assert stepper.current[1] > 0.05
    assert 0.0 < stepper.angle[1] < 0.05 * stepper.speed[1]
    np.testing.assert_array_equal(stepper.shown, stepper.angle)


@pytest.mark.parametrize(
    ("effects", "ready", "duty", "loaded"),
    [
        ({}, {}, 0.0, True),
        ({}, {"ready": True}, 0.0, True),
        ({}, {"ready": False}, 0.0, False),
        ({}, {"ready": False}, 0.1, True),
        ({"constant_load": {"load_torque_nm": 0.02}}, {"ready": False}, 0.0, True),
    ],
)
def test_the_kernel_is_loaded_at_the_first_step_unless_all_may_rest(
    monkeypatch, effects, ready, duty, loaded
):
    stepped = []
    monkeypatch.setattr(
        stepper_module, "kernel", lambda _: SimpleNamespace(step_many=lambda *a: stepped.append(a))
    )
    stepper = Stepper([plant_from_config({**NXT, "effects": effects}, "power_pct")], **ready)
    stepper.step(np.array([duty]), np.zeros(1, dtype=np.int64), 8.0, 1e-3)
    assert bool(stepped) is loaded


def test_a_stepper_gives_room_for_two_columns_and_shows_the_first(monkeypatch):
    """The compiled kernel writes an angle and a speed for each plant, and checks no bounds."""
    read = np.array([[1.0, 10.0], [2.0, 20.0]])
    fake = SimpleNamespace(read_many=lambda *arguments: np.copyto(arguments[-1], read))
    monkeypatch.setattr(stepper_module, "kernel", lambda _: fake)
    np.testing.assert_array_equal(Stepper([with_effect("encoder_eccentricity")] * 2).shown, [1.0, 2.0])


@pytest.mark.parametrize("rests_s", [0.0, 0.2])
def test_a_late_command_counts_from_when_it_was_given_though_the_plant_rested_before(rests_s):
    plant = plant_from_config({**NXT, "effects": {"command_delay": {"delay_s": 0.03}}}, "power_pct")
    stepper = Stepper([plant], ready=False)
    moved = []
    for duty in [0.0] * round(1000 * rests_s) + [0.6] * 60:
        stepper.step(np.array([duty]), np.zeros(1, dtype=np.int64), 8.0, 1e-3)
        moved.append(stepper.angle[0] != 0.0)
    assert moved.index(True) == pytest.approx(1000 * rests_s + 30, abs=2)


@pytest.mark.parametrize("workers", [1, 3])
def test_what_goes_on_abreast_comes_in_order_and_may_itself_be_divided(workers):
    with Simulator(MOTOR, workers=workers) as simulator:

        def tens(n):
            return simulator.abreast(lambda one: 10 * n + one, range(3))

        assert simulator.abreast(tens, range(3)) == [[0, 1, 2], [10, 11, 12], [20, 21, 22]]
        with pytest.raises(ZeroDivisionError):
            simulator.abreast(lambda n: 1 / n, [2, 0, 1])


def test_runs_that_go_on_abreast_are_those_that_go_on_alone():
    run = signals(seconds=1.0)
    job = free_job(run, at_rest(run))
    plants = [with_effect("constant_load", load=0.001 * n) for n in range(6)]

    def reached(plant):
        values, active = plant.vectors()
        return simulator.run(values[None], active[None], [job])[0].predicted[0]

    with Simulator(MOTOR, workers=2) as simulator:
        found, wanted = simulator.abreast(reached, plants), [reached(plant) for plant in plants]
    np.testing.assert_array_equal(found, wanted)
