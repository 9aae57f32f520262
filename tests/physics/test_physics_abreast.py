"""Parameter sets that are run abreast give what each gives by itself."""

import ast

import numpy as np
import pytest
from physics_samples import NXT, job_with_readings

from nxt_twin.physics.abreast import LANES, abreast
from nxt_twin.physics.layout import layout
from nxt_twin.physics.plant import plant_from_config

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


def test_sets_of_different_effects_and_delays_each_keep_their_place(motor_simulator):
    ids = ["cogging", "command_delay", "cogging", "clock_skew", "backlash"]
    plants = [with_effect(one, 1.0 + 0.01 * n) for n in range(5) for one in ids]
    assert_as_alone(motor_simulator, plants, job_with_readings(motor_simulator, seconds=0.3))


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
    scope["run_abreast"](1, np.arange(LANES)[::-1], values, given, predicted, weight, cost)
    np.testing.assert_array_equal(predicted, values + np.array([2.0, 2.0, 6.0]))
    assert (weight == 1.0).all()
    assert "shared = 2.0 * given[k]" in [ast.unparse(node) for node in ast.walk(ast.parse(abreast(run)))]
