from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from nxt_twin.blind.case import NOMINAL
from nxt_twin.blind.families.numbers import Numbers
from nxt_twin.blind.families.workshop.machine import Workshop
from nxt_twin.blind.peers.answers import PEERS, answer_all
from nxt_twin.blind.peers.localised import TRUTH, cells_of_names, f1
from nxt_twin.blind.peers.process_noise import lacks_something
from nxt_twin.blind.peers.recipes import cells_of, freed, lisdd, lisdd_cells, sindy
from nxt_twin.blind.peers.regression import EXPRESSED, regression_of
from nxt_twin.blind.peers.rows import peer_rows
from nxt_twin.blind.verdict import NOTHING_GIVEN, judge
from nxt_twin.fleet.workers.place import HERE
from nxt_twin.recording.case import Case
from nxt_twin.recording.recording import Recording

MOTOR = Numbers(
    resistance_ohm=7.6,
    inductance_h=1e-3,
    torque_constant_nm_per_a=0.49,
    viscous_friction_nm_s_per_rad=1.92e-3,
    inertia_kg_m2=1.2e-3,
    supply_v=8.0,
    coulomb_forward_nm=8.45e-3,
    coulomb_reverse_nm=8.45e-3,
)


def case_with(**changes) -> Case:
    """Twelve seconds of random steps, read at 100 Hz with a fine encoder."""
    machine = Workshop(replace(MOTOR, **changes), 0.0)
    time_s = np.arange(0.0, 12.0, 0.01)
    levels = np.random.default_rng(4).uniform(-90.0, 90.0, 40)
    power = np.round(levels[(time_s / 0.4).astype(int)])
    angle = np.zeros(time_s.size)
    for row in range(1, time_s.size):
        angle[row] = machine.run(time_s[row : row + 1], power[row - 1] / 100.0, 0)[0, 0]
    columns = {
        "time_s": time_s,
        "a_power_pct": power,
        "a_tacho_deg": np.floor(np.rad2deg(angle) * 10.0) / 10.0,
        "battery_v": np.full(time_s.size, 8.0),
    }
    plant = {"kind": "dc_motor", **NOMINAL}
    return Case("case", Path(), plant, (Recording("r1.csv", columns),), (), "a")


@pytest.fixture(scope="module")
def weighted() -> Case:
    return case_with(gravity_torque_nm=0.09)


def test_a_regression_leaves_what_the_plain_model_lacks(weighted):
    plain, lacking = regression_of(case_with()), regression_of(weighted)
    left = [float(np.std(one.without_base(one.acceleration))) for one in (plain, lacking)]
    assert left[1] > 1.5 * left[0]
    assert {effect for effect, _ in lacking.candidates} < set(EXPRESSED)


def test_a_strong_weight_is_among_what_regressions_name(weighted):
    pytest.importorskip("pysindy")
    regression = regression_of(weighted)
    assert "gravity_load" in sindy(regression)
    assert "gravity_load" in freed(regression)


def test_sample_splitting_names_nothing_that_noise_alone_makes(weighted):
    regression = regression_of(weighted)
    noise = np.random.default_rng(1).standard_normal(regression.acceleration.size)
    silent = replace(regression, acceleration=regression.base @ np.array([30.0, -15.0, -7.0]) + noise)
    assert lisdd(silent) == ()


def test_process_noise_speaks_where_the_torque_balance_lacks_something(weighted):
    assert lacks_something(weighted)


def test_a_method_that_says_nothing_scores_nothing():
    answer = {
        "case": "case",
        "effects": [
            {"id": "cogging", "known": True, "size": "large", "main": "cogging_torque_nm", "params": {}}
        ],
        "effect_rms_deg": 1.0,
    }
    rows = peer_rows({"silent": [judge(answer, NOTHING_GIVEN)]}, [{TRUTH: [1, 2], "silent": []}])
    assert rows[1][1].startswith("0/1")
    assert rows[1][-1] == "0.00 of 1"


def test_localisation_counts_cells_that_are_wrong_and_cells_that_are_said_to_be():
    assert f1([({1, 2}, {2, 3}), ({4}, {4})]) == (pytest.approx(4 / 6), 2)
    assert f1([]) is None


def test_a_drag_is_wrong_where_the_motor_is_fast():
    regression = regression_of(case_with(quadratic_drag_nm_s2_per_rad2=2e-3))
    cells = cells_of_names(regression, ["quadratic_drag"])
    fast = {int(cells_of(regression)[row]) for row in np.argsort(np.abs(regression.speed))[-20:]}
    assert fast <= cells
    assert len(cells) < 9
    assert cells_of_names(regression, ["command_delay"]) == frozenset()


def test_sample_splitting_points_at_no_regime_that_noise_alone_makes(weighted):
    regression = regression_of(weighted)
    noise = np.random.default_rng(1).standard_normal(regression.acceleration.size)
    silent = replace(regression, acceleration=regression.base @ np.array([30.0, -15.0, -7.0]) + noise)
    assert lisdd_cells(silent) == frozenset()


def test_what_every_method_has_answered_is_not_asked_again(tmp_path):
    for peer in PEERS:
        (tmp_path / peer.name).mkdir()
        (tmp_path / peer.name / "kept.json").write_text("{}")
    assert list(answer_all([tmp_path / "kept"], tmp_path, HERE)) == [("kept", "")]
    assert all((tmp_path / peer.name / "kept.json").read_text() == "{}" for peer in PEERS)
