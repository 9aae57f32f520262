"""What differs between a robot before and after, from its wheels and a pose from outside."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from diagnose_robot_cases import powered_case, robot_case, robot_of_seed

from nxt_twin.diagnose.changed.to_json import to_json
from nxt_twin.diagnose.dispatch import changed_any, changed_since
from nxt_twin.errors import DiagnosisError
from nxt_twin.physics.robot.drive import drive_from_config
from nxt_twin.recording.recording import Recording
from nxt_twin.view.changes_report import render_changes


def sides(before=(), after=()):
    first, second = robot_case(runs=4, **dict(before)), robot_case(runs=4, lags=(0.01,), **dict(after))
    return replace(first, name="spring"), [replace(second, name="autumn")]


def found(before=(), after=()):
    return changed_any(*sides(before, after))[0]


@pytest.mark.parametrize("truth", [{}, {"radius_m": 0.0288, "track_m": 0.124}])
def test_a_robot_that_is_as_before_has_not_changed_however_far_its_model_is_off(truth):
    said = found(truth, truth)
    assert said.verdict == "unchanged"
    assert said.changes == ()
    assert said.refit["track_m"].after == pytest.approx(truth.get("track_m", 0.12), abs=2e-4)


@pytest.mark.slow_variants
@pytest.mark.parametrize(
    ("truth", "of", "value"),
    [
        ({"ratio": 0.97, "radius_m": 0.028 * 0.985}, ["right_wheel_radius_m"], 0.02716),
        ({"track_m": 0.125}, ["track_m"], 0.125),
        ({"heading_deg": 1.5}, ["pose_offset"], 1.5),
        ({"slips": ((0, (4.0, 5.5, 0.4)), (2, (9.0, 10.5, 0.4)))}, ["wheel_slip"], 0.4),
    ],
)
def test_what_changed_is_named_by_the_part_that_changed(truth, of, value):
    said = found({}, truth)
    assert said.verdict == "changed"
    assert [change.of for change in said.changes] == of
    assert said.changes[0].after == pytest.approx(value, rel=0.05)
    if of[0] != "wheel_slip":
        assert said.fit.improved < 0.2 * said.fit.baseline


def test_a_floor_that_pushes_after_is_no_known_change():
    said = found({}, {"drift": 0.04})
    assert said.verdict == "unexplained"
    assert any("goes with the direction" in note for note in said.notes)


def test_the_answer_is_that_of_the_contract_and_its_page_draws_the_path():
    said = found({}, {"track_m": 0.125})
    content = json.loads(to_json(said))
    assert content["changes"][0]["of"] == "track_m"
    assert content["changes"][0]["before"] == pytest.approx(0.12, abs=2e-4)
    assert content["fit"]["unit"] == "mm"
    assert drive_from_config(said.plant.to_config()).geometry.track_m == pytest.approx(0.125, abs=2e-4)
    assert "path on the floor" in render_changes(said)


def test_a_case_with_before_asks_what_has_changed_since():
    before, (after,) = sides({}, {"track_m": 0.125})
    said = changed_since(replace(after, before=before.recordings))
    assert (said.before, said.verdict) == ("before", "changed")


def test_a_side_without_a_pose_is_refused_by_its_recording():
    before, (after,) = sides()
    columns = {name: one for name, one in after.recordings[0].columns.items() if not name.startswith("pose")}
    bare = replace(after, recordings=(Recording("bare.csv", columns),))
    with pytest.raises(DiagnosisError, match=r"bare\.csv: .*pose"):
        changed_any(before, [bare])


@pytest.mark.slow_variants
@pytest.mark.parametrize(
    ("change", "of"),
    [
        ({"mass_kg": 0.7}, ["payload_mass"]),
        ({}, []),
        ({"dry_nm": 1.8}, ["right_motor.coulomb_friction_nm"]),
    ],
)
def test_powers_tell_what_changed_in_motors_and_body(change, of):
    truth = robot_of_seed(5)
    after = {}
    if "mass_kg" in change:
        after["mass_kg"] = truth.mass_kg + change["mass_kg"]
    if "dry_nm" in change:
        after["dry_nm"] = truth.dry_nm[0], truth.dry_nm[1] * change["dry_nm"]
    sides = powered_case("spring", truth, 1), powered_case("autumn", replace(truth, **after), 2)
    said = changed_any(sides[0], [sides[1]])[0]
    assert [one.of for one in said.changes] == of
    assert not any("Without the powers" in note for note in said.notes)
