"""Where single steps are coloured, windows of simulation alone set parameters and choose effects."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose_cases import concealed

from nxt_twin.blind.case import NOMINAL
from nxt_twin.diagnose.diagnosis import Moved, Ratio
from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.judging.colour import COLOURED, colour
from nxt_twin.diagnose.search.notable import is_repeated
from nxt_twin.diagnose.telling.notes import on_the_load
from nxt_twin.physics.plant import plant_from_config

RUN = np.repeat([0, 1], 3000)


def white(seed):
    return np.random.default_rng(seed).normal(size=(20, RUN.size))


def test_independent_readings_have_no_colour():
    assert colour(white(1), RUN) == pytest.approx(1.0, abs=0.05)


def test_readings_of_which_each_goes_on_in_the_next_have_the_colour_that_theory_gives():
    fresh, kept = white(2), 0.7
    held = fresh.copy()
    for k in range(1, RUN.size):
        held[:, k] = kept * held[:, k - 1] + fresh[:, k]
    expected = 1.0 + 2.0 * kept**2 / (1.0 - kept**2)
    assert colour(held, RUN) == pytest.approx(expected, rel=0.15)
    assert expected > COLOURED


def test_readings_held_for_two_polls_are_coloured():
    fresh = white(3)
    assert colour(np.repeat(fresh[:, ::2], 2, axis=1), RUN) == pytest.approx(1.5, abs=0.1)


def test_by_windows_single_steps_are_run_and_count_for_nothing():
    problem = replace(problem_for(concealed((), seed=152)), by_windows=True)
    single, windows = problem.objective.predicting(), problem.objective.simulating()
    assert set(single.evidence) == {0.0}
    assert len(single.jobs) == len(problem.target.jobs)
    assert windows.evidence == problem.simulated.evidence
    assert set(windows.pull) == {1.0}
    assert problem.objective.worth() == problem.simulated.worth() > 0


@pytest.mark.parametrize(("cycles", "repeats"), [(1.0, False), (1.9, False), (2.1, True), (6.0, True)])
def test_what_is_periodic_has_to_be_seen_twice(cycles, repeats):
    plain = plant_from_config({"kind": "dc_motor", **NOMINAL}, "power_pct")
    effect = plain.layout.effect("cogging")
    values = {p.symbol: p.starts[0] * p.si for p in effect.parameters} | {"cycles": cycles}
    signals = problem_for(concealed((), seed=152)).signals[0]
    one_turn = replace(signals, measured=np.linspace(0.0, 2.0 * np.pi, signals.measured.size))
    assert is_repeated(plain.with_effect(effect.id, values), effect, [one_turn]) is repeats


def moved(before, after, std, unit):
    return Moved(before, after, std, unit)


def test_another_load_is_named_with_what_the_motor_kept():
    (said,) = on_the_load(
        {
            "gravity_torque_nm": moved(0.744, 1.14, 0.01, "N·m"),
            "inertia_kg_m2": moved(0.0321, 0.0371, 1e-4, "kg·m²"),
            "resistance_ohm": moved(3.41, 3.45, 0.02, "Ω"),
        }
    )
    assert "The load is another than the given one" in said
    assert "1.14 N·m (given: 0.744)" in said
    assert "0.0371" in said
    assert "1 % at most" in said


@pytest.mark.parametrize(("after", "std"), [(0.80, 0.001), (1.14, 0.2)])
def test_a_load_that_moved_by_little_or_is_in_doubt_is_not_named(after, std):
    assert on_the_load({"gravity_torque_nm": moved(0.744, after, std, "N·m")}) == ()


def test_what_anchors_leave_open_is_no_doubt_about_another_load():
    gravity = replace(moved(0.744, 1.15, 0.26, "N·m"), ratio=Ratio(30.8, 2.3, "1/s²", "inertia_kg_m2"))
    assert len(on_the_load({"gravity_torque_nm": gravity})) == 1
    vague = replace(gravity, ratio=Ratio(30.8, 10.0, "1/s²", "inertia_kg_m2"))
    assert on_the_load({"gravity_torque_nm": vague}) == ()


def test_a_motor_without_an_arm_has_no_such_load():
    assert on_the_load({"inertia_kg_m2": moved(1e-3, 2e-3, 1e-5, "kg·m²")}) == ()


@pytest.mark.parametrize(("gravity_nm", "named"), [(0.451, 0), (0.542, 0), (0.37, 1)])
def test_a_load_that_shrank_as_all_torques_did_is_no_other_load(gravity_nm, named):
    refit = {
        "gravity_torque_nm": moved(0.542, gravity_nm, 0.001, "N·m"),
        "inertia_kg_m2": moved(0.0282, 0.0234, 1e-4, "kg·m²"),
        "resistance_ohm": moved(2.761, 2.82, 0.02, "Ω"),
        "torque_constant_nm_per_a": moved(1.872, 1.585, 0.02, "N·m/A"),
    }
    assert len(on_the_load(refit)) == named
