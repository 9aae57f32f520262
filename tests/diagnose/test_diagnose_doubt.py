"""What fitted readings leave open, on held-out readings; and sizes that hide what would set an effect apart."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from diagnose_motors import clean_case, settled

from nxt_twin.blind.case import NOMINAL
from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.judging import doubt
from nxt_twin.diagnose.judging.doubt import doubts_of, scatter_of
from nxt_twin.diagnose.judging.horizons import horizons_of
from nxt_twin.diagnose.search.coincidence import are_twins, coincidence_nats
from nxt_twin.diagnose.search.limits import LIMITS
from nxt_twin.diagnose.search.rivals import Rival
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.simulate import Simulator


@pytest.fixture(scope="module")
def doubted():
    """How far held-out simulations err for a doubt in every parameter, by that doubt as a fraction."""
    case = clean_case(41)
    with Simulator(problem_for(case).plant.layout) as simulator:
        problem, _, final = settled(simulator, case)
        scale = np.array([variable.scale for variable in final.fitted.variables])

        def of(fraction):
            return np.array(doubts_of(simulator, problem, final, np.diag((fraction * scale) ** 2)))

        yield problem, of


def test_parameters_without_doubt_leave_no_doubt(doubted):
    problem, of = doubted
    assert of(0.0) == pytest.approx(np.zeros(len(horizons_of(problem))), abs=1e-9)


def test_twice_the_doubt_in_parameters_is_twice_that_in_simulations(doubted):
    _, of = doubted
    assert of(2e-3) == pytest.approx(2.0 * of(1e-3), rel=0.2)
    assert (of(1e-3) > 0.0).all()


def test_doubt_grows_with_the_horizon(doubted):
    _, of = doubted
    assert of(1e-3)[0] < of(1e-3)[-1]


def test_readings_that_are_held_stray_by_the_ages_standard_deviation_times_the_speed():
    case = clean_case(41)
    problem = problem_for(case)
    held = problem.plant.with_effect("sample_hold", {"refresh_period": 0.06})
    speeds = []
    for part in problem.held_out:
        signals = part.signals
        speed = np.gradient(signals.measured[part.counted], signals.time_s[part.counted])
        speeds.append(speed)
    expected = 0.06 / math.sqrt(12.0) * math.sqrt(np.mean(np.concatenate(speeds) ** 2))
    with Simulator(problem.plant.layout) as simulator:
        assert scatter_of(simulator, problem, held) == pytest.approx(expected, rel=0.15)
        assert scatter_of(simulator, problem, problem.plant) == 0.0


@pytest.mark.parametrize(
    ("load_nm", "nats"), [(0.9, LIMITS.coincidence_nats), (-0.9, LIMITS.coincidence_nats), (1.1, 0.0)]
)
def test_a_load_below_friction_is_a_coincidence(load_nm, nats):
    plain = plant_from_config({"kind": "dc_motor", **NOMINAL}, "power_pct")
    friction_nm = NOMINAL["coulomb_friction_nm"]
    loaded = plain.with_effect("constant_load", {"load": load_nm * friction_nm})
    assert coincidence_nats(loaded, plain.layout.effect("constant_load")) == nats


def test_friction_by_direction_is_no_coincidence():
    plain = plant_from_config({"kind": "dc_motor", **NOMINAL}, "power_pct")
    effect = plain.layout.effect("asymmetric_friction")
    values = {p.symbol: p.starts[0] * p.si for p in effect.parameters}
    assert coincidence_nats(plain.with_effect(effect.id, values), effect) == 0.0


@pytest.mark.parametrize(
    ("behind", "simulates_worse", "doubt"),
    [(0.4, False, 0.4), (9.0, False, 1.02), (-9.0, True, -1.02), (149.0, False, 1.02), (151.0, False, 151.0)],
)
def test_twins_share_belief_by_what_speaks_beforehand(behind, simulates_worse, doubt):
    assert Rival(None, behind, None, simulates_worse, is_twin=True).doubt_nats == doubt


@pytest.mark.parametrize(
    ("load_nm", "other", "twins"),
    [(0.9, "asymmetric_friction", True), (1.1, "asymmetric_friction", False), (0.9, "gravity_load", False)],
)
def test_a_load_below_friction_is_the_twin_of_friction_by_direction(load_nm, other, twins):
    plain = plant_from_config({"kind": "dc_motor", **NOMINAL}, "power_pct")
    loaded = plain.with_effect("constant_load", {"load": load_nm * NOMINAL["coulomb_friction_nm"]})
    effect, its = (loaded.layout.effect(name) for name in ("constant_load", other))
    assert are_twins(loaded, effect, its) is twins
    assert not are_twins(loaded, its, effect)


def test_readings_err_less_than_told_nine_times_of_ten_as_moments_are_open(monkeypatch):
    draws = np.random.default_rng(3).normal(5.0, 1.0, 8)
    monkeypatch.setattr(doubt, "horizons_of", lambda _: (2.0,))
    monkeypatch.setattr(doubt, "_late", lambda *_: np.tile(draws[:, None] ** 2, (1, 30)))
    (told,) = doubt.lateness_of(None, SimpleNamespace(held_out=(None, None)), None, None)
    below = (draws.mean() + each * draws.std() for each in (1.25, 1.31))
    assert next(below) < told < next(below)
