import re
import sys
from pathlib import Path

import pytest

from nxt_twin.fleet.findings.found import findings_in
from nxt_twin.view.fleet_page import render_fleet_page, write_fleet_page

sys.path.insert(0, str(Path(__file__).parents[1] / "fleet"))
from fleet_tables import changed_fleet, write_table


@pytest.fixture(scope="module")
def findings(tmp_path_factory):
    return findings_in(write_table(tmp_path_factory.mktemp("page") / "fleet.parquet", changed_fleet()))


@pytest.fixture(scope="module")
def page(findings):
    return render_fleet_page(findings, "fleet.parquet")


def test_the_page_begins_with_what_matters(page):
    sentence = re.search(r"<h1>(.*?)</h1>", page)[1]
    assert sentence == (
        "9 of 40 units lack physics; one unit drifts; two units stand out; one batch differs from the others."
    )


def test_each_finding_stands_in_its_list(page):
    for place, words in {
        "lacks": ("U014", "gap_deg", "4.00 ± 0.05", "One finding may be chance"),
        "drifts": ("U013", "per day", "<svg"),
        "batches": ("B0", "40 % have it"),
        "outliers": ("U015", "nxt-twin changed", "U015/2026-03-01.csv"),
        "failed": ("U999", "run.csv: is empty"),
    }.items():
        section = page.partition(f'<section id="{place}">')[2].partition("</section>")[0]
        assert all(each in section for each in words), place


def test_the_page_needs_nobody_else(page):
    assert not re.search(r'(?:src|href)="(?!#)|url\((?!#)|<script', page)


def test_a_fleet_of_errors_has_a_page(tmp_path):
    rows = {("U1", "s", ""): {"failure": "recording", "error": "is <empty>"}}
    found = findings_in(write_table(tmp_path / "fleet.parquet", rows))
    text = write_fleet_page(found, tmp_path / "pages", "t").read_text(encoding="utf-8")
    assert "No session of 1 could be diagnosed." in text
    assert "is &lt;empty&gt;" in text
