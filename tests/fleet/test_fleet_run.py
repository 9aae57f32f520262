import json
import shutil

import pyarrow.parquet as pq
import pytest
from fleet_samples import POISON

from nxt_twin.fleet.errors import FleetError
from nxt_twin.fleet.parcel import Options
from nxt_twin.fleet.row import SCHEMA
from nxt_twin.fleet.run import FleetTally, diagnose_fleet
from nxt_twin.fleet.table import FleetTable
from nxt_twin.fleet.workers.place import Here


def rows(path):
    return {row["unit"]: row for row in pq.read_table(path).to_pylist()}


def again(fleet, path):
    with FleetTable(path) as table:
        return diagnose_fleet([str(fleet.root)], table, Options(), Here())


@pytest.fixture
def copied(done_fleet, tmp_path):
    """A table of its own for a test that changes it."""
    return shutil.copy(done_fleet.path, tmp_path / "fleet.parquet")


def test_each_session_is_a_row_and_a_poisoned_one_is_a_row_with_its_error(done_fleet):
    found = rows(done_fleet.path)
    assert done_fleet.tally == FleetTally(3, kept=0, diagnosed=2, failed=1)
    assert pq.read_schema(done_fleet.path).equals(SCHEMA)
    assert found["poisoned"]["failure"] == "recording"
    assert found["poisoned"]["error"].startswith("run.csv, row 3, column a_tacho_deg")
    assert found["poisoned"]["verdict"] is None


def test_a_row_says_whose_it_is_and_what_is_missing(done_fleet):
    row = rows(done_fleet.path)["loaded"]
    assert (row["batch"], row["session"], row["when"].day, row["verdict"]) == (
        "B1",
        "2026-03-01",
        1,
        "explained",
    )
    (effect,) = row["effects"]
    (load,) = effect["parameters"]
    assert effect["id"] == "constant_load"
    assert load["low_95"] < 0.05 < load["high_95"]
    assert load["unit"] == "N·m"
    assert 0.0 < row["false_alarm_rate"] < 0.1
    assert row["tried"] > 10
    assert row["sentence"]


def test_what_is_done_is_not_done_again(done_fleet, copied):
    assert again(done_fleet, copied) == FleetTally(3, kept=3)
    assert rows(copied) == rows(done_fleet.path)


def test_only_a_session_whose_content_changed_is_done_again(done_fleet, copied, tmp_path):
    root = shutil.copytree(done_fleet.root, tmp_path / "units")
    file = root / "batch=B2" / "unit=poisoned" / "session=2026-03-02" / "run.csv"
    file.write_text(POISON.replace("nonsense", "other nonsense"), encoding="utf-8")
    with FleetTable(copied) as table:
        tally = diagnose_fleet([str(root)], table, Options(), Here())
    assert tally == FleetTally(3, kept=2, failed=1)
    assert "other nonsense" in rows(copied)["poisoned"]["error"]
    assert len(rows(copied)) == 3


def test_rows_of_a_program_that_was_killed_are_kept(done_fleet, tmp_path):
    path = tmp_path / "fleet.parquet"
    whole = [json.dumps(dict(row, when=None)) for row in rows(done_fleet.path).values()]
    path.with_name("fleet.parquet.journal").write_text("\n".join(whole[:2]) + "\n" + whole[2][:50])
    with FleetTable(path) as table:
        assert len(table.done()) == 2
    assert set(rows(path)) == {json.loads(text)["unit"] for text in whole[:2]}


def test_a_transient_failure_is_tried_again(copied):
    row = dict(rows(copied)["plain"], when=None, failure="worker", error="killed")
    with FleetTable(copied) as table:
        table.add(row)
        assert row["key"] in table.done()
    with FleetTable(copied) as table:
        assert row["key"] not in table.done()


def test_two_programs_do_not_add_to_one_table(copied):
    with FleetTable(copied), pytest.raises(FleetError, match="another program adds to this table"):
        FleetTable(copied)


def test_another_programs_table_is_not_touched(tmp_path):
    other = tmp_path / "mine.parquet"
    other.write_bytes(b"PAR1")
    with pytest.raises(FleetError, match="no readable Parquet file"):
        FleetTable(other)
    assert other.read_bytes() == b"PAR1"
