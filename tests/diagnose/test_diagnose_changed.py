"""Before and after: nothing, one change with its size, two of them, and what cannot be compared."""

from dataclasses import replace

import pytest
from diagnose_changed_pairs import answer, pair

from nxt_twin.diagnose.changed.among import among
from nxt_twin.diagnose.changed.compare import changed
from nxt_twin.diagnose.changed.words import parameter_words
from nxt_twin.errors import DiagnosisError, NxtTwinError
from nxt_twin.view.changes_report import render_changes


def test_recordings_of_one_motor_are_unchanged():
    found = answer(0, "nothing")
    assert (found.verdict, found.changes) == ("unchanged", ())
    assert found.sentence.startswith("Nothing changed")


def test_more_inertia_is_found_with_its_size_and_the_motor_stays():
    found = answer(0, "inertia")
    (change,) = found.changes
    assert found.verdict == "changed"
    assert change.of == "inertia_kg_m2"
    assert change.after / change.before == pytest.approx(1.6, rel=0.1)
    assert change.interval_95[0] < change.after < change.interval_95[1]
    assert found.sentence.startswith("The load changed: inertia")
    assert found.fit.improved < 0.3 * found.fit.baseline
    page = render_changes(found)
    assert page.index(found.sentence.split(":")[0]) < page.index("What changed") < page.index("inertia_kg_m2")
    assert page.count("<svg") >= 2
    assert "http://" not in page.replace("http://www.w3.org", "")


@pytest.mark.slow
def test_a_load_behind_play_is_told_from_one_that_is_fixed():
    (change,) = answer(0, "load behind play").changes
    assert change.of == "backlash"
    assert change.params["gap_deg"].value == pytest.approx(8.0, rel=0.3)


@pytest.mark.slow
def test_a_rubber_band_and_more_friction_are_told_apart():
    found = {change.of: change for change in answer(0, "band and friction").changes}
    assert found.keys() == {"spring_load", "coulomb_friction_nm"}
    stiffness = found["spring_load"].params["stiffness_nm_per_rad"]
    assert stiffness.value == pytest.approx(0.02, rel=0.3)  # angle and duty tell no torques, the model's do
    assert found["spring_load"].before is None
    friction = found["coulomb_friction_nm"]
    assert friction.after / friction.before == pytest.approx(3.0, rel=0.2)


def test_a_supply_that_nobody_read_is_told_from_the_motor():
    found = answer(0, "supply")
    (change,) = found.changes
    assert (found.verdict, change.of) == ("changed", "supply_v")
    assert change.after / change.before == pytest.approx(0.8, rel=0.02)
    assert found.sentence.startswith("The supply changed: supply")
    assert "The motor did not change." in found.sentence
    keys = found.plant.to_config()
    assert keys["supply_v"] == pytest.approx(change.after, rel=1e-3)
    assert keys["resistance_ohm"] == pytest.approx(found.refit["resistance_ohm"].after, rel=1e-3)


def test_a_change_that_no_parameter_or_effect_explains_is_called_so():
    found = answer(0, "a push every so often")
    assert found.verdict == "unexplained"
    assert found.sentence.startswith("Something changed, and no few parameters or effects account for it.")
    before = answer(0, "nothing")
    assert found.fit.improved > 6.0 * before.fit.improved
    assert "no few parameters or effects" in render_changes(found)
    runs = found.held_out
    assert [run.recording for run in runs] == ["after-0.csv", "after-1.csv"]
    assert all(run.measured.shape == run.baseline.shape == run.improved.shape for run in runs)


def test_sides_driven_in_different_ways_are_refused():
    before, after = pair(0, "nothing")
    torque = replace(after.recordings[0], name="still.csv")
    still = {**torque.columns, "a_tacho_deg": 0.0 * torque.columns["a_tacho_deg"]}
    with pytest.raises(DiagnosisError, match="nothing moves"):
        changed(before, [replace(after, recordings=(replace(torque, columns=still),))])
    with pytest.raises(NxtTwinError):
        changed(replace(before, plant={"kind": "rigid_body", "inertia": 1.0}), [after])


def test_of_several_units_the_one_that_differs_is_named():
    other, same = answer(0, "inertia"), answer(0, "nothing")
    one = among([replace(other, name="B"), replace(same, name="C")])
    assert one.sentence.startswith("B differs in inertia 0.0011")
    assert one.sentence.endswith("C is as before.")
    assert (one.differs, one.alike, one.odd_first) == ({"B": ("inertia_kg_m2",)}, ("C",), ())
    assert among([replace(same, name="B"), replace(same, name="C")]).sentence == "before, B and C are alike."


def test_the_first_unit_is_the_odd_one_where_all_others_differ_from_it_alike():
    other = answer(0, "inertia")
    units = among([replace(other, name="B"), replace(other, name="C")])
    assert units.odd_first == ("inertia_kg_m2",)
    assert units.sentence.startswith("before is the odd one: inertia is 0.0011")
    assert units.differs == {"B": (), "C": ()}


def test_a_parameter_reads_without_its_unit():
    assert parameter_words("gravity_torque_nm") == "gravity torque"
    assert parameter_words("viscous_friction_nm_s_per_rad") == "viscous friction"
    assert parameter_words("position_gain_pct_per_deg") == "position gain"
    assert parameter_words("goal_rate_limit_deg_per_s") == "goal rate limit"
    assert parameter_words("drain_v_per_s") == "drain"
