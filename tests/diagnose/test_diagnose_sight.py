"""What recordings could have shown: smallest sizes, poor inputs, false alarms."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from diagnose_motors import recorded, settled

from nxt_twin.blind.case import NOMINAL
from nxt_twin.diagnose.diagnosis import Excitation, Fit
from nxt_twin.diagnose.engine import _is_loose, diagnose, problem_for
from nxt_twin.diagnose.fitting import settling
from nxt_twin.diagnose.fitting.linear import linearise, signatures, trials_of
from nxt_twin.diagnose.judging.calibrate import FalseAlarms, alarms, clean_cases, leftover_threshold
from nxt_twin.diagnose.judging.detectable import _as_found, detectable
from nxt_twin.diagnose.judging.sight import missing_motions
from nxt_twin.diagnose.search.limits import LIMITS
from nxt_twin.diagnose.search.weight import weigh
from nxt_twin.diagnose.telling import words
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.parameter import NXT_SCALE
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.recording import Recording

SEED = 61
SHORT_S = 8.0
TRUTH = {
    "constant_load": lambda size: {"motor": {"constant_torque_nm": size}},
    "voltage_drop": lambda size: {"motor": {"drop_v": size}},
}


@pytest.fixture(scope="module")
def simulator():
    with Simulator(problem_for(recorded(SEED, seconds=SHORT_S)).plant.layout) as made:
        yield made


@pytest.fixture(scope="module")
def clean_linear(simulator):
    problem, _, final = settled(simulator, recorded(SEED, seconds=SHORT_S))
    return problem, linearise(simulator, problem, final)


def gained(simulator, effect_id, size):
    """What the search would hold for an effect of that size in a motor of the other simulator."""
    case = recorded(SEED, seconds=SHORT_S, **TRUTH[effect_id](size))
    _, fitter, final = settled(simulator, case)
    bare = settling.settled(fitter, final.plant, final.noise)
    symbol = final.plant.layout.effect(effect_id).parameters[0].symbol
    richer = settling.settled(fitter, bare.plant.with_effect(effect_id, {symbol: size}), bare.noise)
    weight = weigh(bare, richer)
    return weight.gain > LIMITS.gain_nats and weight.total > LIMITS.gain_nats + LIMITS.check_nats


@pytest.mark.slow_variants
@pytest.mark.parametrize("effect_id", TRUTH)
def test_the_smallest_size_that_would_be_seen_is_right_within_a_factor_of_three(
    simulator, clean_linear, effect_id
):
    found = {one.effect.id: one for one in detectable(simulator, *clean_linear)}
    size = found[effect_id].size
    assert found[effect_id].seen_above
    assert gained(simulator, effect_id, 2.0 * size)
    assert not gained(simulator, effect_id, 0.35 * size)


def test_a_limit_is_seen_below_a_size_and_a_friction_above(simulator, clean_linear):
    found = {one.effect.id: one for one in detectable(simulator, *clean_linear)}
    assert not found["current_limit"].seen_above
    assert not found["shaft_compliance"].seen_above
    assert found["quadratic_drag"].seen_above
    assert found["asymmetric_friction"].difference


@pytest.mark.parametrize(("factor", "told"), [(0.7, True), (1.0, False)])
def test_friction_by_direction_cannot_be_more_than_all_of_it(factor, told):
    plain = plant_from_config({"kind": "dc_motor", **NOMINAL}, "power_pct")
    effect = plain.layout.effect("asymmetric_friction")
    size = _as_found(effect, plain, NXT_SCALE, math.log(factor), seen_above=True).size
    assert (size is not None) is told
    assert size is None or size < 2.0 * plain.values[Slot("coulomb_friction", "coulomb")]


@pytest.mark.parametrize(
    ("count", "last"), [(4, "or d"), (5, "or one other effect"), (6, "or 2 other effects")]
)
def test_of_more_than_four_unseen_effects_the_others_are_counted(count, last):
    unseen = Excitation(enough=False, lacks=(), unseen=tuple("abcdef"[:count]))
    fit = Fit("free-run RMSE", "deg", 1.0, 1.0, 1.0)
    assert words.sentence("adequate", (), fit, unseen).endswith(f"{last}.")


@pytest.mark.parametrize(
    ("changes", "loose"),
    [
        ({}, True),
        ({"remaining": 2.0}, False),
        ({"doubts": (0.9, 0.1)}, False),
        ({"floors": (0.9, 0.3)}, False),
    ],
)
def test_parameters_are_open_where_doubt_in_them_moves_unseen_windows_by_more_than_noise(changes, loose):
    made = {"remaining": 3.01, "doubts": (0.1, 0.3), "floors": (0.1, 0.2)} | changes
    evidence = SimpleNamespace(
        record=SimpleNamespace(remaining=made["remaining"]),
        doubts=made["doubts"],
        floors=made["floors"],
        final_errors=SimpleNamespace(seconds=(0.5, 2.0)),
        problem=SimpleNamespace(window_s=2.0),
    )
    assert _is_loose(evidence) is loose


@pytest.mark.parametrize("enough", [True, False])
def test_an_adequate_model_with_open_parameters_is_not_praised(enough):
    unseen = Excitation(enough=enough, lacks=(), unseen=("a",))
    said = words.sentence("adequate", (), Fit("free-run RMSE", "deg", 47.0, 47.0, 1.0), unseen, loose=True)
    assert "leave the parameters open" in said
    assert "47 deg off" in said
    assert "Nothing is missing" not in said
    assert ("could not have shown a." in said) is not enough


def test_what_the_recordings_lack_is_told_beside_what_they_could_not_show():
    unseen = Excitation(enough=False, lacks=("its command never rests near zero",), unseen=("a",))
    said = words.sentence("adequate", (), Fit("free-run RMSE", "deg", 4.0, 4.0, 1.0), unseen)
    assert "could not have shown a. In these recordings, its command never rests near zero." in said


def test_clean_recordings_raise_no_alarm_and_an_effect_does(simulator, clean_linear):
    problem, linear = clean_linear
    plant = linear.structure.plant
    trials = trials_of(plant.layout.effect("gravity_load"), problem.scale)
    clean = clean_cases(linear, np.random.default_rng(3))
    assert not alarms(simulator, linear, trials, clean).any()
    shaken = clean + 0.05 * signatures(simulator, linear, plant, trials[:1])
    assert alarms(simulator, linear, trials, shaken).all()


def test_made_up_clean_cases_look_like_a_clean_recording(clean_linear):
    _, linear = clean_linear
    clean = clean_cases(linear, np.random.default_rng(4))
    assert np.mean(clean**2) == pytest.approx(np.mean(linear.innovations**2), rel=0.15)
    again = clean_cases(linear, np.random.default_rng(4))
    assert np.array_equal(clean, again)


def test_no_alarm_in_so_many_cases_leaves_a_bound():
    assert FalseAlarms(0, 200).rate == 0.0
    assert 0.005 < FalseAlarms(0, 200).upper_95 < 0.02
    assert FalseAlarms(10, 200).upper_95 > 0.05


def test_the_limit_of_a_leftover_is_above_every_clean_one():
    made = np.random.default_rng(5).normal(10.0, 4.0, 60)
    assert leftover_threshold(made, 15.0) >= made.max()
    assert leftover_threshold(made - 40.0, 15.0) == 15.0


def one_way(seed):
    """Two recordings that only ever run forward at one speed."""
    case = recorded(seed, families=("steps", "steps", "steps"), seconds=SHORT_S)
    made = []
    for recording in (*case.recordings, *case.holdout):
        time_s = recording.time_s
        on_s = np.maximum(time_s - 0.3, 0.0)
        angle = np.floor(500.0 * (on_s - 0.05 * (1.0 - np.exp(-on_s / 0.05))))
        columns = {
            **recording.columns,
            "a_power_pct": np.where(time_s < 0.3, 0.0, 60.0),
            "a_tacho_deg": angle,
        }
        columns.pop("a_mode", None)
        made.append(Recording(recording.name, columns))
    return replace(case, recordings=tuple(made[:2]), holdout=tuple(made[2:]))


@pytest.mark.slow
def test_a_single_speed_in_one_direction_is_said_to_be_too_little():
    case = one_way(62)
    said = " ".join(missing_motions(problem_for(case)))
    for part in ("never turns the other way", "one steady speed", "command changes only"):
        assert part in said
    diagnosis = diagnose(case).diagnosis
    assert diagnosis.excitation is not None
    assert not diagnosis.excitation.enough
    assert {"asymmetric_friction", "stiction"} & set(diagnosis.excitation.unseen)
    if diagnosis.verdict == "adequate":
        assert "could not have shown" in diagnosis.sentence
        assert diagnosis.next_experiment is not None
        assert diagnosis.next_experiment.program is not None


def test_lively_inputs_lack_nothing(clean_linear):
    problem, _ = clean_linear
    said = missing_motions(problem)
    assert all("other way" not in part and "steady speed" not in part for part in said)
    assert math.isfinite(sum(map(len, said)))
