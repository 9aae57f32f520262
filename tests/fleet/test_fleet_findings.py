import json

import numpy as np
import pytest
from fleet_tables import changed_fleet, plain_fleet, write_table

from nxt_twin.errors import NxtTwinError
from nxt_twin.fleet.findings.control import q_values
from nxt_twin.fleet.findings.found import findings_in
from nxt_twin.fleet.findings.moderated import lines
from nxt_twin.fleet.findings.to_json import to_json
from nxt_twin.fleet.findings.values import LEVEL


@pytest.fixture(scope="session")
def changed(tmp_path_factory):
    return findings_in(write_table(tmp_path_factory.mktemp("table") / "fleet.parquet", changed_fleet()))


def test_units_that_lack_an_effect_are_named_with_its_size(changed):
    gaps = [lack for lack in changed.lacks if lack.effect == "backlash"]
    assert [lack.unit for lack in gaps] == [f"U{n:03}" for n in range(0, 16, 2)]
    assert (gaps[0].found, gaps[0].sessions, gaps[0].parameter) == (3, 3, "gap_deg")
    assert gaps[0].value == pytest.approx(4.0)
    (share,) = (share for share in changed.shares if share.effect == "backlash")
    assert (share.found, share.sure, share.units) == (8, 8, 40)
    assert share.low_95 < 8 / 40 < share.high_95


def test_a_single_weak_finding_among_many_units_is_possible_and_not_sure(changed):
    assert changed.possible == 1
    assert "cogging" not in {lack.effect for lack in changed.lacks}
    assert "cogging" in {share.effect for share in changed.shares}


def test_a_unit_whose_sessions_all_stay_unexplained_lacks_something_unknown(changed):
    assert [lack.unit for lack in changed.lacks if lack.effect == "unknown"] == ["U019"]


def test_a_unit_that_drifts_is_found_with_its_slope_per_day(changed):
    (drift,) = changed.drifts
    assert (drift.unit, drift.parameter, drift.per) == ("U013", "inertia_kg_m2", "day")
    assert drift.slope == pytest.approx(8e-5)
    assert drift.at == (0.0, 1.0, 2.0)


def test_the_unit_that_stands_out_is_found_beside_a_typical_one(changed):
    assert changed.outliers[0].unit == "U015"
    outlier = changed.outliers[0]
    assert outlier.source == "U015/2026-03-01.csv"
    assert outlier.typical[0] not in {each.unit for each in changed.outliers}


def test_what_a_batch_has_in_common_is_found(changed):
    (common,) = changed.commons
    assert (common.batch, common.of, common.kind, common.units) == ("B0", "backlash", "effect", 20)
    assert (common.inside, common.outside) == (0.4, 0.0)


def test_a_session_without_an_answer_is_listed(changed):
    assert [(each.unit, each.error) for each in changed.failed] == [("U999", "run.csv: is empty")]
    assert (changed.sessions, changed.units) == (121, 40)


@pytest.mark.parametrize("seed", range(3))
def test_of_a_fleet_that_differs_by_chance_alone_hardly_anything_is_said(tmp_path, seed):
    found = findings_in(write_table(tmp_path / "fleet.parquet", plain_fleet(seed=seed)))
    assert not found.lacks
    assert len(found.drifts) + len(found.commons) + len(found.outliers) <= 1


def test_a_fleet_of_errors_alone_says_so(tmp_path):
    rows = {("U1", "s", ""): {"failure": "recording", "error": "is empty"}}
    found = findings_in(write_table(tmp_path / "fleet.parquet", rows))
    assert (found.units, len(found.failed), found.lacks) == (0, 1, ())


def test_the_json_holds_each_finding_and_no_number_that_is_none(changed):
    told = json.loads(to_json(changed, "fleet.parquet"))
    assert told["schema"] == "nxt-twin/fleet/1"
    assert told["false_discovery_rate"] == LEVEL
    assert [each["unit"] for each in told["drifts"]] == ["U013"]
    assert next(each for each in told["lacks"] if each["effect"] == "unknown")["value"] is None


def test_tests_that_found_nothing_count_among_those_that_were_made():
    p = np.array([1e-4, 0.02])
    assert q_values(p, 100) == pytest.approx([0.01, 1.0])
    assert q_values(p) == pytest.approx([2e-4, 0.02])


def test_lines_through_exact_values_keep_the_doubt_of_the_fits():
    x = np.array([0.0, 1.0, 2.0, 0.0])
    fitted = lines(np.array([0, 0, 0, 1]), 2, x, 3.0 * x, np.full(4, 0.1))
    assert fitted.slope[0] == pytest.approx(3.0)
    assert 0.06 < fitted.slope_std[0] < 0.1 / np.sqrt(2.0)
    assert np.isnan(fitted.slope[1])
    assert fitted.mean.tolist() == pytest.approx([3.0, 0.0])


def test_a_table_that_is_not_there_is_told(tmp_path):
    with pytest.raises(NxtTwinError, match="there is no such table"):
        findings_in(tmp_path / "none.parquet")
