"""The check of the docs passes on ours, and names each gap that it is there to find."""

import re
from typing import get_args

import pytest

from nxt_twin.recording.columns import CATALOGUE
from nxt_twin.recording.recording import InputKind, OutputKind


@pytest.fixture(scope="module")
def docs_check(_tools):
    import docs_check

    return docs_check


@pytest.fixture(scope="module")
def formats(root):
    return (root / "docs" / "formats.md").read_text(encoding="utf-8")


def test_our_docs_are_whole(docs_check, root):
    assert list(docs_check.findings(root)) == []


def test_a_verb_that_no_page_calls_is_named(docs_check, root):
    text = re.sub(r"nxt-twin recover|`recover`", "", docs_check.prose(root))
    assert list(docs_check.verbs(text)) == [
        "nxt-twin recover: no page tells of this command; write `nxt-twin recover` in one"
    ]


@pytest.mark.parametrize(
    ("section", "key"),
    [
        ("Mapping files", "wraps_at"),
        ("Cases", "holdout"),
        ("Motor programs", "most_turn_deg"),
        ("Plant files", "goal_delay_s"),
        ("Plant files", "track_m"),
        ("Robot paths", "turn_deg"),
        ("Diagnosis JSON", "held_out"),
    ],
)
def test_a_key_that_its_section_leaves_out_is_named(docs_check, formats, section, key):
    gaps = list(docs_check.keys(re.sub(rf"\b{key}\b", "gone", formats)))
    assert gaps == [f"docs/formats.md, {section}: leaves out the key '{key}'"]


@pytest.mark.parametrize(
    ("page", "effect"), [("effects", "backlash"), ("sensors", "light_flicker"), ("robots", "wheel_slip")]
)
def test_an_effect_that_its_page_leaves_out_is_named(docs_check, root, page, effect):
    text = (root / "docs" / f"{page}.md").read_text(encoding="utf-8").replace(f"`{effect}`", "")
    assert list(docs_check.effects(page, text)) == [f"docs/{page}.md: leaves out the effect '{effect}'"]


def test_an_exit_status_that_no_page_tells_is_named(docs_check, formats, tmp_path):
    (tmp_path / "odd.py").write_text("import sys\nimport typer\nsys.exit(1)\nraise typer.Exit(code=3)\n")
    (gap,) = docs_check.statuses(formats, tmp_path)
    assert gap.startswith("odd.py:4: leaves with 3")


def test_a_page_outside_the_site_and_a_dead_link_are_named(docs_check, tmp_path):
    (tmp_path / "docs").mkdir()
    (tmp_path / "mkdocs.yml").write_text("nav: [index.md]\n")
    (tmp_path / "docs" / "lost.md").write_text("# Lost\n\n[away](gone.md), [here](#no-such-section)\n")
    (outside,) = docs_check.unlisted(tmp_path)
    assert "lost.md: stands in no part" in outside
    dead = list(docs_check.house_pages.pages(tmp_path))
    assert "gone.md" in dead[0]
    assert "no-such-section" in dead[1]


def test_every_column_stands_in_the_page_of_formats(docs_check, formats):
    ports_and_slots = {
        re.sub(r"^[bc]_", "a_", re.sub(r"^s[234]_(?!ultra)", "s1_", name)) for name in CATALOGUE
    }
    assert ports_and_slots <= docs_check.named(formats, "Recordings") | {
        f"s{n}_ultrasonic_cm" for n in (2, 3)
    }


def test_every_kind_of_signal_stands_in_the_page_of_formats(docs_check, formats):
    assert {*get_args(InputKind), *get_args(OutputKind)} <= docs_check.named(formats, "Mapping files")
