"""Motors that angle and voltage cannot tell apart."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose_motors import clean_case

from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting.fit import fit
from nxt_twin.diagnose.fitting.likeness import most_likely, told_apart
from nxt_twin.diagnose.fitting.noise import first_noise, with_noise
from nxt_twin.diagnose.fitting.variables import starts_of, variables_of
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.configs import load_plant_config

LARGER = 1.3
MOTOR = plant_from_config(load_plant_config("nxt_motor"), "power_pct")
RESISTANCE = Slot("base", "resistance")


@pytest.fixture(scope="module")
def problem():
    return problem_for(clean_case(41))


@pytest.fixture(scope="module")
def simulator(problem):
    with Simulator(problem.plant.layout) as simulator:
        yield simulator


def alike(plant):
    """The motor of which every torque is so much larger, moved by as much more current."""
    parameters = plant.layout.parameters
    return plant.with_values(
        {slot: value * LARGER ** parameters[slot].likeness for slot, value in plant.values.items()}
    )


def predicted(simulator, problem, plant):
    values, active = plant.vectors()
    jobs = [replace(job, step_s=1e-3) for job in problem.target.jobs]
    return np.concatenate([r.predicted[0] for r in simulator.run(values[None], active[None], jobs)])


@pytest.mark.parametrize("effect_id", sorted(effect.id for effect in MOTOR.layout.effects))
def test_a_motor_and_its_like_move_the_same_whatever_is_in_them(simulator, problem, effect_id):
    effect = problem.plant.layout.effect(effect_id)
    plant = problem.plant.with_effect(effect_id, starts_of(effect, problem.scale)[0])
    own, other = (predicted(simulator, problem, one) for one in (plant, alike(plant)))
    assert np.abs(other - own).max() < 1e-6 * np.ptp(own)


def test_what_is_not_declared_alike_does_change_the_motion(simulator, problem):
    plant = problem.plant
    other = plant.with_values({RESISTANCE: LARGER * plant.values[RESISTANCE]})
    own, moved = (predicted(simulator, problem, one) for one in (plant, other))
    assert np.abs(moved - own).max() > 1e-3 * np.ptp(own)


def test_slopes_keep_everything_but_what_lies_between_motors_that_are_alike():
    rng = np.random.default_rng(3)
    along = np.array([1.0, -0.5, 0.0])
    slopes = rng.normal(size=(3, 40))
    kept = told_apart(slopes, along)
    assert np.allclose(along @ kept, 0.0)
    across = np.array([0.5, 1.0, 2.0])
    assert np.allclose(across @ kept, across @ slopes)
    assert np.array_equal(told_apart(slopes, np.zeros(3)), slopes)


@pytest.mark.parametrize("logs", [False, True])
def test_the_likeliest_of_them_is_where_the_priors_rest(logs):
    centre, spread = np.array([2.0, 8.0, 1.0]), np.array([1.0, 0.8, 0.1])
    likeness = np.array([1.0, -1.0, 0.0])
    x = np.array([6.0, 3.0, 1.4])
    moved = np.full(3, logs)
    centre = np.log(centre) if logs else centre
    found = most_likely(np.log(x) if logs else x, likeness, centre, spread, moved)
    best = np.exp(found) if logs else found
    assert best[2] == pytest.approx(x[2])
    assert best[0] * best[1] == pytest.approx(x[0] * x[1])

    def doubt(size):
        grown = x * np.exp(likeness * size)
        return ((((np.log(grown) if logs else grown) - centre) / spread) ** 2).sum()

    sizes = np.linspace(-2.0, 2.0, 4001)
    assert np.log(best[0] / x[0]) == pytest.approx(sizes[np.argmin([doubt(s) for s in sizes])], abs=2e-3)


def test_a_fit_that_begins_far_along_comes_back_to_the_given_resistance(simulator, problem):
    noise = first_noise(problem.plant, problem.signals, problem.scale.torque)
    target = with_noise(problem.target, noise)

    def resistance(start):
        variables = variables_of(start, problem.plant, problem.scale)
        fitted, _ = fit(simulator, start, variables, target, iterations=8, covariance=False)
        return fitted.plant.values[RESISTANCE]

    far = alike(alike(alike(problem.plant)))
    assert resistance(far) == pytest.approx(resistance(problem.plant), rel=0.02)
