import shutil
import sys
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from fleet_samples import write_poison

sys.path.insert(0, str(Path(__file__).parents[1] / "cli"))
from cli_program import run


def test_a_second_run_keeps_every_row(done_fleet, tmp_path):
    table = shutil.copy(done_fleet.path, tmp_path / "fleet.parquet")
    outcome = run("fleet", "diagnose", done_fleet.root, "--out", table)
    assert outcome.status == 0
    assert "3 sessions: 0 diagnosed, 3 kept from before, 0 failed" in outcome.out


def test_a_fleet_without_an_answer_is_a_failure_with_its_table(tmp_path):
    write_poison(tmp_path / "units" / "U1" / "s" / "a.csv")
    table = tmp_path / "out" / "fleet.parquet"
    outcome = run("fleet", "diagnose", tmp_path / "units", "--out", table, "--jobs", "1")
    assert outcome.status == 1
    assert "no session could be diagnosed" in outcome.err
    assert pq.read_table(table, columns=["failure"]).to_pylist() == [{"failure": "recording"}]
    assert not table.with_name("fleet.parquet.journal").exists()


def test_the_findings_of_the_whole_table_are_a_page_and_json(done_fleet, tmp_path):
    table = shutil.copy(done_fleet.path, tmp_path / "fleet.parquet")
    outcome = run("fleet", "diagnose", done_fleet.root, "--out", table, "--json", "-", "--report", tmp_path)
    told = outcome.json()
    assert [lack["effect"] for lack in told["lacks"]] == ["constant_load"]
    assert [each["unit"] for each in told["failed"]] == ["poisoned"]
    assert "loaded" in (tmp_path / "fleet.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("module", "arguments", "what"),
    [
        ("fsspec", ["memory://units"], "cannot be reached"),
        ("distributed", ["{root}", "--cluster", "tcp://127.0.0.1:9"], "a cluster needs Dask"),
    ],
)
def test_without_the_extra_one_line_says_how_to_get_it(
    done_fleet, tmp_path, monkeypatch, module, arguments, what
):
    monkeypatch.setitem(sys.modules, module, None)
    given = [each.format(root=done_fleet.root) for each in arguments]
    outcome = run("fleet", "diagnose", *given, "--out", tmp_path / "fleet.parquet")
    assert outcome.status == 1
    assert what in outcome.err
    assert "nxt-twin[fleet]" in outcome.err
    assert outcome.err.count("\n") == 1
