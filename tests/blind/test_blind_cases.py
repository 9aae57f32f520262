from __future__ import annotations

import hashlib
import json

import numpy as np
import pytest

from nxt_twin.blind.case import NOMINAL, SEAL_FILE
from nxt_twin.blind.effects.library import EFFECTS, KNOWN_EFFECTS, UNKNOWN_EFFECTS
from nxt_twin.blind.make import make_case, write_case
from nxt_twin.blind.sets import plan_set
from nxt_twin.errors import CaseError
from nxt_twin.recording.case import read_case

QUICK = {"duration_s": 2.5, "recordings": 2}
BRIEF = {"duration_s": 2.0, "recordings": 1}
UNSEEN_IN_ONE = ("winding_heating", "current_limit", "missed_counts")
CONTRACT_PARAMETERS = {
    "coulomb_friction": ["coulomb_friction_nm"],
    "viscous_friction": ["viscous_friction_nm_s_per_rad"],
    "inductance": ["inductance_h"],
    "presliding": ["presliding_deg"],
    "stiction": ["breakaway_torque_nm", "stribeck_speed_rad_s"],
    "asymmetric_friction": ["coulomb_forward_nm", "coulomb_reverse_nm"],
    "load_dependent_friction": ["friction_per_torque"],
    "quadratic_drag": ["quadratic_drag_nm_s2_per_rad2"],
    "friction_warmup": ["cold_extra_torque_nm", "time_constant_s"],
    "angle_dependent_friction": ["binding_torque_nm", "cycles_per_turn"],
    "backlash": ["gap_deg", "load_inertia_kg_m2"],
    "shaft_compliance": ["stiffness_nm_per_rad", "load_inertia_kg_m2"],
    "gravity_load": ["gravity_torque_nm", "phase_deg"],
    "cogging": ["cogging_torque_nm", "cycles_per_turn"],
    "payload_inertia": ["added_inertia_kg_m2"],
    "end_stop": ["limit_deg"],
    "constant_load": ["load_torque_nm"],
    "spring_load": ["stiffness_nm_per_rad", "rest_angle_deg"],
    "battery_sag": ["internal_resistance_ohm"],
    "battery_drain": ["drain_v_per_s"],
    "winding_heating": ["resistance_rise_per_joule", "thermal_time_constant_s"],
    "current_limit": ["current_limit_a"],
    "voltage_drop": ["drop_v"],
    "power_curve": ["exponent"],
    "command_delay": ["delay_s"],
    "clock_skew": ["rate_error", "lag_span_s"],
    "stale_samples": ["stale_fraction"],
    "missed_counts": ["loss_fraction", "speed_threshold_rad_s"],
    "encoder_eccentricity": ["amplitude_deg", "cycles_per_turn"],
}


def same(one, other) -> bool:
    return all(
        np.array_equal(a.columns[name], b.columns[name], equal_nan=True)
        for a, b in zip(one.recordings, other.recordings, strict=True)
        for name in a.columns
    )


def test_a_seed_makes_the_same_case_again_and_another_seed_another():
    first, again, other = (make_case(seed, effects=("stiction",), **QUICK) for seed in (3, 3, 4))
    assert first.answer == again.answer
    assert same(first, again)
    assert first.answer["base"] != other.answer["base"]


def test_every_documented_motor_effect_can_be_hidden():
    assert set(KNOWN_EFFECTS) == set(CONTRACT_PARAMETERS)
    assert len(UNKNOWN_EFFECTS) >= 10


@pytest.mark.parametrize("effect", CONTRACT_PARAMETERS)
def test_answer_names_the_documented_parameters_and_larger_is_more_visible(effect):
    length = {**BRIEF, "recordings": 2} if effect in UNSEEN_IN_ONE else BRIEF
    small, large = (
        make_case(12, effects=(effect,), size=size, **length).answer for size in ("small", "large")
    )
    hidden = large["effects"][0]
    assert hidden["id"] == effect
    assert set(CONTRACT_PARAMETERS[effect]) <= set(hidden["params"])
    assert hidden["main"] in hidden["params"]
    assert large["effect_rms_deg"] > max(small["effect_rms_deg"], 0.1)


@pytest.mark.parametrize("effect", UNKNOWN_EFFECTS)
def test_an_unknown_effect_moves_the_motor_and_says_that_it_is_unknown(effect):
    answer = make_case(12, effects=(effect,), size="large", **QUICK).answer
    assert not answer["effects"][0]["known"]
    assert answer["effect_rms_deg"] > 2.0


def test_a_clean_case_records_the_whole_degrees_below_the_true_angle():
    case = make_case(5, effects=(), duration_s=5.0)
    assert case.answer["effects"] == []
    assert case.answer["effect_rms_deg"] == 0.0
    for recording in case.recordings:
        true_deg = np.array(case.answer["recordings"][recording.name]["hub_deg"])
        below_deg = true_deg - recording.columns["a_tacho_deg"]
        assert below_deg.min() >= -1e-3
        assert below_deg.max() <= 1.0 + 1e-3
        assert np.all(np.diff(recording.time_s) > 0.0)
        power = recording.columns["a_power_pct"]
        assert np.array_equal(power, np.round(power))
        assert np.abs(power).max() <= 100.0
        battery = recording.columns["battery_v"]
        assert np.isfinite(battery[0])
        assert 0.02 < np.isfinite(battery).mean() < 0.09
        assert np.nanmax(np.abs(battery - case.answer["base"]["supply_v"])) < 0.04


def test_the_true_motor_is_off_the_nominal_one_which_the_solver_sees():
    case = make_case(6, effects=(), **QUICK)
    plant = dict(case.content["plant"])
    assert plant.pop("kind") == "dc_motor"
    assert plant == NOMINAL
    base = case.answer["base"]
    off = [base[key] / NOMINAL[key] - 1.0 for key in NOMINAL if key != "supply_v"]
    assert max(map(abs, off)) > 0.02
    assert max(map(abs, off)) <= 0.2 + 1e-9
    assert base["torque_constant_nm_per_a"] == base["back_emf_v_s_per_rad"]


@pytest.mark.parametrize("effect", ["coulomb_friction", "viscous_friction", "inductance"])
def test_a_plain_term_is_hidden_by_leaving_its_key_out(effect):
    case = make_case(7, effects=(effect,), **QUICK)
    assert CONTRACT_PARAMETERS[effect][0] not in case.content["plant"]
    assert len(case.content["plant"]) == len(NOMINAL)


def test_viscous_friction_is_always_recorded_with_a_coasting_motor():
    for seed in range(4):
        case = make_case(seed, effects=("viscous_friction",), duration_s=1.5)
        families = [recording["family"] for recording in case.answer["recordings"].values()]
        assert "coast_downs" in families[:2]


def test_recordings_of_a_case_have_different_inputs():
    case = make_case(8, effects=(), duration_s=3.0)
    assert len({recording["family"] for recording in case.answer["recordings"].values()}) == 3


def test_links_poll_at_their_own_pace():
    usb, bluetooth = (
        np.diff(make_case(9, effects=(), link=link, duration_s=10.0, recordings=1).recordings[0].time_s)
        for link in ("usb", "bluetooth")
    )
    assert 0.0095 < np.median(usb) < 0.0105
    assert 0.02 < np.median(bluetooth) < 0.045
    assert np.std(bluetooth) > 0.004


def test_battery_drain_is_not_given_away_by_the_battery_column():
    case = make_case(10, effects=("battery_drain",), duration_s=3.0)
    for recording in case.recordings:
        assert np.isfinite(recording.columns["battery_v"]).sum() == 1


def test_a_written_case_is_read_back_and_its_answer_lies_elsewhere_sealed(tmp_path):
    case = make_case(13, effects=("backlash",), duration_s=3.0, name="case-0001")
    folder = write_case(case, tmp_path / "cases", tmp_path / "answers")
    answer = tmp_path / "answers" / "case-0001.json"
    assert (folder / SEAL_FILE).read_text().strip() == hashlib.sha256(answer.read_bytes()).hexdigest()
    assert json.loads(answer.read_text())["effects"][0]["id"] == "backlash"
    assert "backlash" not in "".join(
        path.read_text() for path in folder.iterdir() if path.suffix in {".yaml", ".csv", ".sha256"}
    )
    read = read_case(folder)
    written = {recording.name: recording for recording in case.recordings}
    assert len(read.recordings) + len(read.holdout) == 3
    for recording in (*read.recordings, *read.holdout):
        for name, values in written[recording.name].columns.items():
            np.testing.assert_array_equal(recording.columns[name], values)


def test_salt_keeps_equal_answers_from_having_equal_seals():
    salts = {make_case(seed, effects=(), duration_s=2.0, recordings=1).answer["salt"] for seed in range(3)}
    assert len(salts) == 3


def test_an_effect_that_is_none_is_refused_with_the_known_ones():
    with pytest.raises(CaseError, match=r"no effect 'gremlins'.*stiction"):
        make_case(1, effects=("gremlins",))


def test_effects_that_set_the_same_term_cannot_stand_together():
    with pytest.raises(CaseError, match="cannot stand in one case"):
        make_case(1, effects=("backlash", "shaft_compliance"))


def test_a_full_set_holds_each_effect_in_each_size_and_the_mixtures():
    plans = plan_set(1)
    single_count = 3 * len(KNOWN_EFFECTS)
    counts = [sum(len(plan.effects) == n for plan in plans) for n in range(4)]
    assert counts == [40, single_count + 10, 30, 10]
    assert len({plan.name for plan in plans}) == len(plans)
    assert len({plan.seed for plan in plans}) == len(plans)
    singles = {(plan.effects[0], plan.size) for plan in plans if plan.size}
    assert len(singles) == single_count
    assert len({plan.effects for plan in plans[:40]}) > 10, "the order tells nothing"
    assert all(
        not EFFECTS[first].clashes or other not in EFFECTS[first].clashes
        for plan in plans
        for first in plan.effects
        for other in plan.effects
    )


def test_a_planned_set_holds_the_effect_a_clean_case_and_an_unknown_one():
    plans = plan_set(2, effects=("command_delay",), sizes=("large",), clean=1, pairs=0, triples=0, unknown=1)
    assert [plan.name for plan in plans] == ["case-0001", "case-0002", "case-0003"]
    assert {len(plan.effects) for plan in plans} == {0, 1}


@pytest.mark.parametrize(
    ("effects", "wanted", "told"),
    [
        ((), {"pairs": 4, "triples": 0}, "no pairs can be made: no effects"),
        (("cogging",), {"pairs": 1, "triples": 0}, "no pairs can be made: the effects cogging"),
        (("cogging", "gravity_load"), {"pairs": 1, "triples": 1}, "no triples"),
        (("backlash", "shaft_compliance"), {"pairs": 1, "triples": 0}, "no pairs"),  # they exclude each other
    ],
)
def test_pairs_and_triples_need_effects_that_stand_together(effects, wanted, told):
    with pytest.raises(CaseError, match=told):
        plan_set(3, effects=effects, **wanted)
    assert plan_set(3, effects=effects, pairs=0, triples=0)


def test_an_end_stop_is_met_in_two_recordings_and_passed_in_none():
    case = make_case(14, effects=("end_stop",), size="medium", duration_s=5.0)
    limit_deg = case.answer["effects"][0]["params"]["limit_deg"]
    runs = [np.array(recording["hub_deg"]) for recording in case.answer["recordings"].values()]
    side = 1.0 if max(run[0] for run in runs) < limit_deg else -1.0
    beyond_deg = sorted(float((side * (run - limit_deg)).max()) for run in runs)
    assert beyond_deg[-1] < 1.0
    assert beyond_deg[-2] > -0.1


def test_torque_noise_disturbs_the_motor_and_nothing_else():
    calm, noisy = (make_case(15, effects=(), torque_noise_nm=noise, **QUICK) for noise in (0.0, 2e-3))
    assert calm.answer["base"] == noisy.answer["base"]
    one, other = calm.recordings[0], noisy.recordings[0]
    np.testing.assert_array_equal(one.columns["a_power_pct"], other.columns["a_power_pct"])
    shift_deg = np.subtract(
        *(np.array(case.answer["recordings"]["r1.csv"]["hub_deg"]) for case in (calm, noisy))
    )
    assert 0.1 < np.abs(shift_deg).max() < 50.0
