import numpy as np
import pytest
from diagnose_cases import concealed

from nxt_twin.diagnose.engine import fit_as_it_stands, problem_for
from nxt_twin.diagnose.fitting import fit as fitting
from nxt_twin.diagnose.fitting.noise import damping_per_s
from nxt_twin.diagnose.fitting.variables import starts_of, variables_of
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.parameter import NXT_SCALE
from nxt_twin.recording.case import Case
from nxt_twin.recording.recording import Recording, SignalKinds


def euler_cart(*, mass, viscous, coulomb, load, seconds, seed):
    """A cart under random steps of force, by explicit Euler at 20 µs: not the formulas of the fit."""
    rng = np.random.default_rng(seed)
    steps = round(seconds / 2e-5)
    force = np.repeat(rng.uniform(-60.0, 60.0, round(seconds / 0.4) + 1), 20_000)[:steps]
    position, speed, path = 0.0, 0.0, np.empty(steps // 500)
    for k in range(steps):
        if k % 500 == 0:
            path[k // 500] = position
        pull = force[k] + load - viscous * speed - coulomb * np.tanh(speed / 1e-5)
        speed += 2e-5 * pull / mass
        position += 2e-5 * speed
    time_s = np.arange(path.size) * 0.01
    noisy = path + rng.normal(0.0, 2e-6, path.size)
    columns = {"time_s": time_s, "input": force[::500][: path.size], "output": noisy}
    return Recording(f"cart-{seed}", columns, SignalKinds("force_n", "position_m"))


@pytest.mark.usefixtures("one_by_one")
def test_a_fit_finds_the_parameters_of_a_cart_made_by_other_formulas(tmp_path):
    truth = {"mass": 95.0, "viscous": 200.0, "coulomb": 20.0, "load": 3.0}
    runs = tuple(euler_cart(**truth, seconds=8.0, seed=seed) for seed in (1, 2))
    plant = {
        "kind": "rigid_body",
        "inertia": 80.0,
        "viscous_friction": 260.0,
        "coulomb_friction": 12.0,
        "effects": {"constant_load": {"load_force_n": 1.0}},
    }
    fitted = fit_as_it_stands(Case("cart", tmp_path, plant, runs, (), None)).plant.values
    assert fitted[Slot("base", "inertia")] == pytest.approx(95.0, rel=0.02)
    assert fitted[Slot("viscous_friction", "viscous")] == pytest.approx(200.0, rel=0.05)
    assert fitted[Slot("coulomb_friction", "coulomb")] == pytest.approx(20.0, rel=0.05)
    assert fitted[Slot("constant_load", "load")] == pytest.approx(3.0, rel=0.1)


def test_a_re_fit_moves_everything_but_anchors_and_ties_what_is_known_as_a_ratio():
    problem = problem_for(concealed((), seed=21))
    variables = variables_of(problem.plant, problem.plant, problem.scale)
    assert Slot("base", "supply_v") not in {slot for v in variables for slot in v.slots}
    tied = [{slot.symbol for slot in v.slots} for v in variables if len(v.slots) > 1]
    assert tied == [{"resistance", "winding"}, {"torque_constant", "back_emf"}]


def test_starts_cover_every_combination_in_si():
    backlash = problem_for(concealed((), seed=21)).plant.layout.effect("backlash")
    starts = starts_of(backlash, NXT_SCALE)
    assert len(starts) == 6
    assert all(start["gap"] < 0.5 for start in starts)


def test_the_time_constant_of_an_nxt_motor_is_some_tens_of_milliseconds():
    assert 0.02 < 1.0 / damping_per_s(problem_for(concealed((), seed=21)).plant) < 0.08


@pytest.mark.parametrize("wild", [np.nan, np.inf])
def test_where_a_run_ran_away_a_fit_rests_instead_of_failing(wild):
    hessian, gradient, free = np.diag([4.0, 2.0]), np.array([8.0, 2.0]), np.array([True, True])
    np.testing.assert_allclose(fitting._step(hessian, gradient, free, 0.0), [-2.0, -1.0])
    for place in (hessian, gradient):
        before, place.flat[0] = place.flat[0], wild
        assert not fitting._step(hessian, gradient, free, 0.0).any()
        place.flat[0] = before
