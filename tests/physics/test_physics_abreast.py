"""Parameter sets that are run abreast give what each gives by itself."""

import ast
from dataclasses import replace

import numpy as np
import pytest
from physics_samples import NXT, commanded, job_with_readings, moving

from nxt_twin.physics.abreast import FEWEST, LANES, abreast
from nxt_twin.physics.layout import layout
from nxt_twin.physics.observer import Observer
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.simulate import free_job
from nxt_twin.physics.start import restarts

MOTOR = layout("dc_motor", "motor")


def with_effect(effect_id, factor=1.0):
    plant = plant_from_config(NXT, "power_pct")
    effect = MOTOR.effect(effect_id)
    return plant.with_effect(effect_id, {p.symbol: factor * p.starts[0] * p.si for p in effect.parameters})


def assert_as_alone(simulator, plants, job):
    values, active = (np.array(part) for part in zip(*(plant.vectors() for plant in plants), strict=True))
    together = simulator.run(values, active, [job])[0]
    for n in range(len(plants)):
        alone = simulator.run(values[n : n + 1], active[n : n + 1], [job])[0]
        for name in ("predicted", "weight", "cost"):
            one, other = getattr(together, name)[n], getattr(alone, name)[0]
            np.testing.assert_allclose(one, other, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("effect_id", [effect.id for effect in MOTOR.effects if not effect.plain])
def test_sets_abreast_run_as_alone(motor_simulator, effect_id):
    plants = [with_effect(effect_id, 1.0 + 0.02 * n) for n in range(LANES - 2)]
    assert_as_alone(motor_simulator, plants, job_with_readings(motor_simulator, seconds=0.5))


def test_sets_whose_lags_differ_between_some_stamps_alone_run_as_alone(motor_simulator):
    # The lags agree at whole seconds, where sets are first told apart: the sine passes zero there.
    run = commanded([(10.0, 60.0), (14.0, -60.0)], seconds=8.0, stamps=10.0 + 0.01 * np.arange(801))
    skew = MOTOR.effect("clock_skew")
    usual = {p.symbol: p.starts[0] * p.si for p in skew.parameters}
    wandering = [
        {
            **usual,
            "rate_error": 0.0,
            "lag_mean": 0.0,
            "lag_period": 1.0,
            "lag_phase": 0.25,
            "lag_span": span_s,
        }
        for span_s in (0.0, 0.02, 0.05)
    ]
    plant = plant_from_config(NXT, "power_pct")
    plants = [plant.with_effect("clock_skew", own) for own in wandering for _ in range(FEWEST)]
    assert_as_alone(motor_simulator, plants, free_job(run, moving(run)))


def test_sets_whose_commands_follow_their_polls_otherwise_run_as_alone(motor_simulator):
    run = commanded([(0.0, 0.7), (0.3, -0.4), (0.55, 0.6)], seconds=1.0)
    polls_s = np.array([[0.02, 0.0], [0.05, 0.01], [0.03, 0.04]])
    plant = plant_from_config(NXT, "power_pct")
    plants = [
        plant.with_effect("command_delay", {"command_delay": 0.01, "poll_share": share})
        for share in (0.0, 1.0, -0.5)
        for _ in range(FEWEST)
    ]
    assert_as_alone(motor_simulator, plants, free_job(replace(run, command_polls=polls_s), moving(run)))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "config", "command", "level"),
    [
        ("rotary", {"kind": "rigid_body", "inertia": 2e-3, "viscous_friction": 5e-3}, "torque_nm", 0.1),
        ("linear", {"kind": "rigid_body", "inertia": 2.0, "viscous_friction": 5.0}, "force_n", 1.0),
        ("servo", {**NXT, "kind": "servo", "position_gain_pct_per_deg": 1.0}, "goal_position_rad", 1.0),
    ],
)
def test_sets_of_other_plants_abreast_run_as_alone(request, kind, config, command, level):
    plants = [
        plant_from_config({**config, key: (1.0 + 0.1 * n) * config[key]}, command)
        for key in config.keys() & {"viscous_friction", "position_gain_pct_per_deg"}
        for n in range(LANES)
    ]
    run = commanded([(0.0, level), (0.1, -level)], seconds=0.3, kind=command)
    simulator = request.getfixturevalue(f"{kind}_simulator")
    assert_as_alone(simulator, plants, free_job(run, moving(run)))


def test_sets_of_different_effects_and_delays_each_keep_their_place(motor_simulator):
    ids = ["cogging", "command_delay", "cogging", "clock_skew", "backlash"]
    plants = [with_effect(one, 1.0 + 0.01 * n) for n in range(5) for one in ids]
    assert_as_alone(motor_simulator, plants, job_with_readings(motor_simulator, seconds=0.3))


def test_one_recording_under_several_gains_and_starts_runs_as_each_alone(motor_simulator):
    plants = [with_effect("missed_counts", 1.0 + 0.02 * n) for n in range(3)]
    values, active = (np.array(part) for part in zip(*(plant.vectors() for plant in plants), strict=True))
    tuned = job_with_readings(motor_simulator, seconds=0.5)
    anew = free_job(tuned.signals, restarts(tuned.signals, 0.1))
    weak = replace(tuned, observer=Observer(0.3 * tuned.observer.gains, 2.0 * tuned.observer.innovation_std))
    jobs = [tuned, weak, replace(tuned, start=anew.start), anew]
    for job, together in zip(jobs, motor_simulator.run(values, active, jobs), strict=True):
        for n in range(len(plants)):
            alone = motor_simulator.run(values[n : n + 1], active[n : n + 1], [job])[0]
            for name in ("predicted", "weight", "cost"):
                one, other = getattr(together, name)[n], getattr(alone, name)[0]
                np.testing.assert_allclose(one, other, rtol=1e-8, atol=1e-8)


def test_what_sets_share_is_done_once_and_what_differs_in_each_lane():
    run = """
def run(values, given, predicted, weight, cost, trace):
    gain = values[0]
    for k in range(3):
        shared = 2.0 * given[k]
        if given[k] > 0.0:
            gain += shared
        predicted[k] = gain
        weight[k] = 1.0
        cost[k] = 0.0
        if trace.shape[0] > 0:
            trace[k] = gain
"""
    scope = {"np": np}
    exec(abreast(run), scope)
    predicted, weight, cost = np.zeros((3, LANES, 3))
    values, given = np.arange(float(LANES))[:, None], np.array([1.0, -1.0, 2.0])
    rows = np.arange(LANES)[::-1]
    scope["run_abreast"](1, rows, np.zeros(LANES, dtype=int), values, given, predicted, weight, cost)
    np.testing.assert_array_equal(predicted, values + np.array([2.0, 2.0, 6.0]))
    assert (weight == 1.0).all()
    assert "shared = 2.0 * given[k]" in [ast.unparse(node) for node in ast.walk(ast.parse(abreast(run)))]
