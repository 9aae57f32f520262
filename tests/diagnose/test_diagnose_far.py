"""Parameters that a re-fit moved tenfold, or to nothing."""

import csv
import math
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

import nxt_twin as nt
from nxt_twin.diagnose.engine import _what_stays, diagnose
from nxt_twin.diagnose.fitting.tamed import tamed
from nxt_twin.diagnose.telling.far import furthest_off, moved_far, moved_notably, stays
from nxt_twin.recording.case import read_case

GIVEN = nt.load_plant("nxt_motor")
LIGHT = 0.06  # of the true inertia
STEP_S, POLL_S, LENGTH_S = 1e-4, 0.02, 10.0


def refitted(**times):
    """The plant with some keys multiplied."""
    keys = GIVEN.to_config()
    return nt.load_plant({**keys, **{name: keys[name] * factor for name, factor in times.items()}})


@pytest.mark.parametrize(
    ("times", "parts"),
    [
        ({"inertia_kg_m2": 12.0}, ["inertia_kg_m2 to 0.0144 kg·m², 12 times the given 0.0012"]),
        ({"coulomb_friction_nm": 0.0}, ["coulomb_friction_nm to 0 N·m, none of the given 0.00845"]),
        ({"inertia_kg_m2": 0.05, "viscous_friction_nm_s_per_rad": 20.0}, ["0.05 times", " and ", "20 times"]),
    ],
)
def test_the_answer_begins_with_a_quantity_that_vanished_or_grew_tenfold(times, parts):
    (said,) = moved_far(GIVEN, refitted(**times))
    assert said.startswith("The re-fit moved ")
    for part in parts:
        assert part in said


def test_several_numbers_that_moved_tenfold_ask_for_a_look_at_units_and_model():
    found = refitted(inertia_kg_m2=0.01, torque_constant_nm_per_a=0.02, coulomb_friction_nm=0.0)
    said, check = moved_far(GIVEN, found)
    assert said.startswith("The re-fit moved 3 numbers tenfold or to nothing: inertia_kg_m2 (0.01 times), ")
    assert "torque_constant_nm_per_a (0.02 times)" in said
    assert "coulomb_friction_nm (none)" in said
    assert check.startswith("Check the units")
    assert len(moved_far(GIVEN, refitted(inertia_kg_m2=0.01, torque_constant_nm_per_a=0.02))) == 1


def test_nothing_is_said_of_numbers_that_may_not_have_moved():
    found = refitted(inertia_kg_m2=12.0, coulomb_friction_nm=4.0)
    assert moved_far(GIVEN, found, {"inertia_kg_m2"}) == ()
    assert moved_notably(GIVEN, found, {"coulomb_friction_nm"}) == ()
    assert len(moved_far(GIVEN, found)) == len(moved_notably(GIVEN, found)) == 1


def test_nothing_is_said_of_smaller_moves_or_of_effects_that_replace_a_key():
    assert moved_far(GIVEN, refitted(inertia_kg_m2=9.0, coulomb_friction_nm=0.11)) == ()
    assert moved_far(GIVEN, GIVEN.without(["coulomb_friction"])) == ()


@pytest.mark.parametrize(
    ("times", "told"), [(2.9, False), (3.1, True), (9.9, True), (10.1, False), (0.34, False), (0.32, True)]
)
def test_a_note_tells_a_quantity_that_moved_by_more_than_three_times(times, told):
    said = moved_notably(GIVEN, refitted(inertia_kg_m2=times))
    assert len(said) == told
    assert all(f"{times:.3g} times the given 0.0012" in one for one in said)


def test_what_single_steps_would_rather_have_is_told_where_the_given_numbers_simulate_better():
    wanted = refitted(inertia_kg_m2=1.2, viscous_friction_nm_s_per_rad=0.5)
    (said,) = stays(GIVEN, GIVEN, wanted, coloured=True)
    assert "with which a simulation errs more: the given ones stay" in said
    assert "most of viscous_friction_nm_s_per_rad, 0.00096 N·m·s/rad in place of 0.00192" in said
    assert "held, stamped late or taken at another rate" in said
    (plain,) = stays(GIVEN, GIVEN, wanted, coloured=False)
    assert "stamped late" not in plain


def test_nothing_is_told_of_single_steps_that_got_their_way_or_ask_for_little():
    wanted = refitted(inertia_kg_m2=1.2)
    assert stays(GIVEN, wanted, wanted, coloured=True) == ()
    assert stays(GIVEN, GIVEN, refitted(inertia_kg_m2=1.09), coloured=True) == ()
    assert stays(GIVEN, GIVEN, refitted(inertia_kg_m2=1.11), coloured=True)


@pytest.mark.parametrize(
    ("by_windows", "found", "colour", "told"),
    [(False, (), 1.45, 1), (False, (), 1.35, 1), (True, (), 1.7, 0), (False, ("spring_load",), 1.7, 0)],
)
def test_single_steps_ask_for_nothing_beside_effects_or_windows_that_decide_alone(
    by_windows, found, colour, told
):
    evidence = SimpleNamespace(
        problem=SimpleNamespace(by_windows=by_windows, plant=GIVEN),
        explanation=SimpleNamespace(baseline=SimpleNamespace(plant=refitted(inertia_kg_m2=1.2)), found=found),
        baseline=SimpleNamespace(plant=GIVEN),
        record=SimpleNamespace(colour=colour),
    )
    said = _what_stays(evidence)
    assert len(said) == told
    assert ("stamped late" in "".join(said)) == (told == 1 and colour > 1.4)


def test_the_number_that_is_furthest_off_is_so_by_how_sure_it_was():
    found = refitted(inertia_kg_m2=3.0, torque_constant_nm_per_a=1.5)
    assert furthest_off(GIVEN, found) == (
        "torque_constant_nm_per_a would be 0.736 N·m/A, 1.5 times the given 0.491"
    )
    assert furthest_off(GIVEN.without(["inductance"]), refitted(inertia_kg_m2=30.0)).startswith("inertia")


def test_the_squares_of_a_simulation_that_ran_away_are_numbers():
    wild = tamed(np.array([np.inf, -1e200, np.nan, 2.0]))
    assert np.isfinite(wild @ wild)
    np.testing.assert_array_equal(wild[2:], [0.0, 2.0])
    assert wild[0] > 0.0 > wild[1]


def written(path, seed):
    """Ten seconds of a motor by Euler's method, with friction as a smooth function of speed."""
    keys, rng = GIVEN.to_config(), np.random.default_rng(seed)
    constant, inertia = keys["torque_constant_nm_per_a"], keys["inertia_kg_m2"]
    angle = speed = current = until_s = 0.0
    duty, rows = 0, []
    for step in range(round(LENGTH_S / STEP_S)):
        now_s = step * STEP_S
        if step % round(POLL_S / STEP_S) == 0:
            if now_s >= until_s:
                duty = int(rng.choice([-1, 1]) * rng.integers(25, 100))
                until_s = now_s + rng.uniform(0.3, 1.0)
            rows.append((f"{now_s:.3f}", duty, math.floor(math.degrees(angle) + 0.5)))
        voltage = duty / 100 * keys["supply_v"] - keys["resistance_ohm"] * current - constant * speed
        current += STEP_S * voltage / keys["inductance_h"]
        friction = keys["coulomb_friction_nm"] * math.tanh(speed / 0.02)
        friction += keys["viscous_friction_nm_s_per_rad"] * speed
        speed += STEP_S * (constant * current - friction) / inertia
        angle += STEP_S * speed
    with path.open("w", newline="") as file:
        csv.writer(file).writerows([("time_s", "a_power_pct", "a_tacho_deg"), *rows])
    return path.name


def test_a_diagnosis_from_a_far_too_light_model_begins_with_it_and_simulates_no_worse(tmp_path):
    plant = {**GIVEN.to_config(), "inertia_kg_m2": LIGHT * GIVEN.to_config()["inertia_kg_m2"]}
    recordings = [written(tmp_path / f"run{seed}.csv", seed) for seed in range(3)]
    (tmp_path / "case.yaml").write_text(yaml.safe_dump({"plant": plant, "recordings": recordings}))
    diagnosis = diagnose(read_case(tmp_path)).diagnosis
    assert diagnosis.verdict == "adequate"
    assert diagnosis.sentence.startswith("The re-fit moved inertia_kg_m2 to ")
    assert "times the given 7.2e-05. Nothing is missing" in diagnosis.sentence
    for horizon in diagnosis.fit.horizons:
        assert horizon.baseline < 0.1 * horizon.given
