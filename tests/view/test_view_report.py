import math
import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
import view_samples as samples

from nxt_twin.diagnose.diagnosis import Alternative, Confusion, Estimate, FoundEffect, Mismatch, Moved, Spell
from nxt_twin.view.report import render_report, write_report

VOID = {"meta", "br"}

EVERY_SAMPLE = {
    "explained": lambda: samples.explained(runs=2),
    "adequate": samples.adequate,
    "unexplained": lambda: samples.brief(samples.unexplained()),
    "unexplained with help": lambda: samples.brief(samples.unexplained(helped=True)),
    "stale": samples.with_stale_samples,
}


class Page(HTMLParser):
    """What a reader of the page finds, in order."""

    def __init__(self, source):
        super().__init__()
        self.source = source
        self.open_tags = []
        self.sections = []
        self.tags = []
        self.attributes = []
        self.outline = []
        self.words = {}
        self.feed(source)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes.extend(attrs)
        if tag not in VOID:
            self.open_tags.append(tag)
        if tag in ("header", "section", "footer"):
            self.sections.append(dict(attrs).get("id", tag))
        if tag in ("h1", "h2", "h3", "h4"):
            self.outline.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes.extend(attrs)

    def handle_endtag(self, tag):
        assert self.open_tags.pop() == tag

    def handle_data(self, data):
        if "style" in self.open_tags:
            return
        section = self.sections[-1] if self.sections else "head"
        self.words[section] = self.words.get(section, "") + data
        if data.strip() and self.open_tags[-1] not in ("h1", "h2", "h3", "h4"):
            self.outline.append("content")

    def text(self, section=None):
        found = self.words.get(section, "") if section else " ".join(self.words.values())
        return " ".join(found.split())


@pytest.fixture(scope="module")
def pages():
    return {name: Page(render_report(make())) for name, make in EVERY_SAMPLE.items()}


def svgs_of(page):
    return re.findall(r"<svg.*?</svg>", page.source, flags=re.DOTALL)


def test_the_report_reads_from_the_sentence_to_what_is_left(pages):
    assert pages["explained"].sections == [
        "verdict", "picture", "numbers", "doubt", "next", "leftover", "footer",
    ]  # fmt: skip


def test_what_is_left_comes_right_after_the_picture_where_nothing_explains_it(pages):
    assert pages["unexplained"].sections == [
        "verdict", "picture", "leftover", "numbers", "doubt", "next", "footer",
    ]  # fmt: skip
    assert "The shape of what is left" in pages["unexplained"].text("leftover")


def test_an_adequate_model_has_no_improved_curve_and_says_so(pages):
    page = pages["adequate"]
    assert page.sections == ["verdict", "picture", "numbers", "leftover", "footer"]
    assert "Nothing was added to the model" in page.text("picture")
    assert "improved" not in page.text()
    assert "What was missing" not in page.text()


def test_an_unexplained_mismatch_without_help_has_no_improved_curve(pages):
    assert "No known effect helps" in pages["unexplained"].text("picture")
    assert "improved" not in pages["unexplained"].text("picture")
    assert "improved" in pages["unexplained with help"].text("picture")


@pytest.mark.parametrize("name", EVERY_SAMPLE)
def test_the_verdict_and_its_sentence_come_first(pages, name):
    diagnosis = EVERY_SAMPLE[name]()
    first = pages[name].text("verdict")
    assert diagnosis.verdict in first
    assert diagnosis.sentence in first
    assert diagnosis.name in first


@pytest.mark.parametrize("name", EVERY_SAMPLE)
def test_the_page_needs_no_network(pages, name):
    source = pages[name].source.lower()
    for trace in ("http", "//", "@import", "src=", "<script", "<link"):
        assert trace not in source
    assert all(
        value.startswith("#") for key, value in pages[name].attributes if key in ("href", "xlink:href")
    )
    assert all(target == "#" for target in re.findall(r"url\((.)", source))


@pytest.mark.parametrize("name", EVERY_SAMPLE)
def test_every_opened_element_is_closed_and_no_heading_stands_empty(pages, name):
    page = pages[name]
    assert page.open_tags == []
    for heading, after in zip(page.outline, [*page.outline[1:], "end"], strict=True):
        assert heading == "content" or after == "content" or (heading < after and after != "end")


@pytest.mark.parametrize("name", EVERY_SAMPLE)
def test_pictures_are_well_formed_with_ids_of_their_own(pages, name):
    pictures = svgs_of(pages[name])
    assert pictures
    ids = []
    for svg in pictures:
        root = ET.fromstring(svg)
        ids += [node.get("id") for node in root.iter() if node.get("id")]
        assert root.get("viewBox")
        assert {"time (s)", "time in the recording (s)"} & {node.text for node in root.iter("text")}
    assert len(ids) == len(set(ids))
    references = set(re.findall(r'(?:url\(|href=")#([^)"]+)', "".join(pictures)))
    assert references == set(ids)


def test_pictures_name_their_curves_and_units_in_real_text(pages):
    first = {node.text for node in ET.fromstring(svgs_of(pages["explained"])[0]).iter("text")}
    assert {"measured", "baseline", "improved", "tacho A (deg)", "power (%)", "12 σ"} <= first
    assert "improved" not in {node.text for node in ET.fromstring(svgs_of(pages["adequate"])[0]).iter("text")}


def test_numbers_stand_with_their_doubt(pages):
    numbers = pages["explained"].text("numbers")
    for shown in ("0.0312 ± 0.0021 N·m", "−3.2 ± 2.4 deg", "0.00192", "0.00210 ± 0.00004", "+9.4 %", "+56 %"):
        assert shown in numbers
    for shown in ("low speed", "14.2", "p < 10⁻¹⁶", "p = 2 × 10⁻⁹", "> 99.9 %", "Free-run RMSE, held-out"):
        assert shown in numbers
    assert "torque_balance" in numbers


def test_the_doubt_names_confusions_and_what_came_second(pages):
    doubt = pages["explained"].text("doubt")
    for shown in (
        "presliding",
        "these runs rarely rest there",
        "stiction + cogging",
        "2.0 %",
        "4.10",
        "11.9",
    ):
        assert shown in doubt


def test_next_experiment_and_notes_are_told(pages):
    told = pages["explained"].text("next")
    assert "Ramp the power from 0 to 30 %" in told
    assert samples.ANCHOR in told
    assert "as good as the anchor" in pages["explained"].text("footer")
    assert "anchor" not in pages["adequate"].text("footer")


def test_stale_samples_are_marked_and_counted(pages):
    stale = samples.with_stale_samples().held_out
    assert "judged stale" in pages["stale"].text("picture")
    assert any(
        f"{int(run.stale.sum())} samples judged stale" in pages["stale"].text("picture") for run in stale
    )
    assert "× stale sample, left out" in "".join(svgs_of(pages["stale"]))
    assert "stale" not in pages["explained"].source.split("</style>")[1]


@pytest.mark.usefixtures("undrawn")
def test_every_held_out_run_is_in_the_table_and_five_are_drawn():
    diagnosis = samples.explained(runs=13, samples=300)
    page = Page(render_report(diagnosis))
    assert all(run.recording in page.text("numbers") for run in diagnosis.held_out)
    assert page.tags.count("figure") == 5 + 1
    assert page.tags.count("details") == 1
    assert "four more held-out runs" in page.text("picture")


def test_a_strangers_text_is_shown_as_text():
    diagnosis = samples.explained(runs=1, samples=300)
    wild = "<script>alert('a')</script> & <b>bold</b>"
    named = replace(diagnosis.held_out[0], recording=wild)
    page = Page(
        render_report(
            replace(diagnosis, name=wild, sentence=wild, notes=(wild,), held_out=(named,), effects=())
        )
    )
    assert "script" not in page.tags
    assert "<script>alert('a')</script> & <b>bold</b>" in page.text("verdict")
    assert page.open_tags == []
    for svg in svgs_of(page):
        ET.fromstring(svg)


def test_a_bare_diagnosis_leaves_no_empty_section():
    bare = replace(
        samples.adequate(),
        verdict="unexplained",
        refit={},
        mismatch=Mismatch("", (), (), None),
        held_out=(),
        leftover=None,
    )
    page = Page(render_report(bare))
    assert page.sections == ["verdict", "numbers", "footer"]
    assert [entry for entry in page.outline if entry != "content"] == ["h1", "h2", "h3"]
    assert page.outline[-1] == "content"
    assert page.text("numbers").count("0.42") == 2


def test_tiny_huge_and_missing_numbers_are_drawn_without_warning():
    diagnosis = samples.explained(runs=3, samples=300)
    runs = [
        replace(
            run, time_s=run.time_s + 86400.0, command=run.command * 1e-6, measured=-1e-7 * run.measured,
            baseline=-1e-7 * run.baseline, improved=-1e-7 * run.improved,
        )
        for run in diagnosis.held_out
    ]  # fmt: skip
    runaway = np.where(np.arange(300) > 200, np.inf, runs[0].baseline * np.exp(np.arange(300) * 0.2))
    gaps = np.where(np.arange(300) % 3 == 0, runs[1].measured, np.nan)
    still = np.zeros(300)
    wild = replace(
        diagnosis,
        held_out=(
            replace(runs[0], recording="runaway", baseline=runaway, baseline_rmse=math.inf),
            replace(runs[1], recording="gaps", measured=gaps),
            replace(runs[2], recording="still", measured=still, improved=still, baseline=still),
            replace(runs[2], recording="nothing", measured=np.full(300, np.nan), baseline_rmse=math.nan),
        ),
        fit=replace(diagnosis.fit, baseline=math.inf, improved=0.0, floor=0.0),
        refit={"inertia": Moved(0.0, -1e-12, math.nan, "kg")},
        effects=(
            FoundEffect("own", "own", "y", {"x": Estimate(-3e11, 2e9, "N")}, 0.4, (Confusion("a", "b"),)),
        ),
        alternatives=(Alternative("other", 0.0, math.inf),),
    )
    page = Page(render_report(wild))
    pictures = "".join(svgs_of(page))
    assert "baseline leaves the picture" in pictures
    assert "10⁻⁶ m" not in pictures
    assert page.tags.count("figure") == 3 + 1
    for shown in ("nothing", "∞", "(−3.000 ± 0.020) × 10¹¹ N"):
        assert shown in page.text("numbers")


def test_an_adequate_answer_lists_what_was_left_out(pages):
    left = (Alternative("shaft_compliance", 0.5, 1.2),)
    told = Page(render_report(replace(samples.adequate(), alternatives=left))).text("doubt")
    assert "left out" in told
    assert "shaft_compliance" in told
    assert "left out" not in pages["unexplained"].text("doubt")


def test_spells_of_other_runs_and_times_are_not_shaded():
    diagnosis = samples.explained(runs=1, samples=300)
    elsewhere = (Spell("another.csv", 0.5, 1.0, 33.0), Spell("run_01.csv", 90.0, 91.0, 44.0))
    page = Page(render_report(replace(diagnosis, mismatch=replace(diagnosis.mismatch, when=elsewhere))))
    assert "Shaded" not in page.text("picture")
    assert "33 σ" not in page.source
    assert "44.0" in page.text("numbers")


def test_the_same_diagnosis_gives_the_same_page(pages):
    assert render_report(samples.adequate()) == pages["adequate"].source


def test_long_recordings_give_a_short_file(tmp_path):
    rng = np.random.default_rng(3)
    rows = 100_000
    time_s = np.arange(rows) * 1e-3
    diagnosis = samples.explained(runs=5)
    runs = []
    for run in diagnosis.held_out:
        measured = 1000 * np.sin(3 * time_s) + rng.normal(0, 3, rows)
        baseline = measured + rng.normal(0, 30, rows)
        stale = (rng.random(rows) < 0.1).astype(float)
        command = 100 * np.sign(np.sin(40 * time_s))
        runs.append(
            replace(
                run, time_s=time_s, command=command, measured=measured, baseline=baseline,
                improved=measured - 1, stale=stale,
            )
        )  # fmt: skip
    left = samples.leftover(lambda speed, _: 1e-3 * speed, lambda speed, _: 0 * speed, samples=rows)
    path = write_report(replace(diagnosis, held_out=tuple(runs), leftover=left), tmp_path)
    assert path.stat().st_size < 2_000_000


@pytest.mark.usefixtures("undrawn")
def test_the_file_is_named_after_the_case(tmp_path):
    diagnosis = samples.explained(runs=1, samples=300)
    path = write_report(diagnosis, tmp_path / "new" / "folder")
    assert path == tmp_path / "new" / "folder" / "arm-on-port-a.html"
    assert path.read_text(encoding="utf-8") == render_report(diagnosis)


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(
    ("case", "file"),
    [
        ("a/b\\c<b>", "a_b_c_b_.html"),
        ("..", "diagnosis.html"),
        ("é" * 400, "é" * 100 + ".html"),
        ("", "diagnosis.html"),
    ],
)
def test_no_case_name_escapes_the_folder(tmp_path, case, file):
    path = write_report(replace(samples.explained(runs=1, samples=300), name=case), tmp_path)
    assert path.parent == tmp_path
    assert path.name == file


def drawn(run, **changes):
    diagnosis = samples.explained(runs=1, samples=600)
    return Page(render_report(replace(diagnosis, held_out=(run,), **changes)))


def test_no_curve_is_drawn_across_a_stretch_that_was_not_held_out():
    run = samples.explained(runs=1, samples=600).held_out[0]
    kept = np.r_[0:200, 400:600]
    fields = ("time_s", "command", "measured", "baseline", "improved", "stale")
    broken = replace(run, **{name: getattr(run, name)[kept] for name in fields})

    def pieces(page):
        curves = [path for path in svgs_of(page)[0].split("<path")[1:] if "var(--c-improved)" in path]
        return max(path.split('"')[1].count("M") for path in curves)

    assert pieces(drawn(broken)) == pieces(drawn(run)) + 1


@pytest.mark.usefixtures("undrawn")
def test_a_departure_is_shaded_only_where_it_leaves_most_of_the_run_alone():
    run = samples.explained(runs=1, samples=600).held_out[0]
    mismatch = samples.explained(runs=1, samples=600).mismatch
    for until_s, shaded in ((2.0, True), (6.0, False)):
        spells = (Spell(run.recording, 0.0, until_s, 9.0),)
        page = drawn(run, mismatch=replace(mismatch, when=spells))
        assert ("Shaded: where the baseline departs" in page.text("picture")) == shaded


def test_colours_follow_the_page_and_pictures_stack_on_a_phone():
    page = drawn(samples.explained(runs=1, samples=600).held_out[0])
    assert "prefers-color-scheme: dark" in page.source
    wide, narrow = svgs_of(page)[:2]
    assert "var(--c-muted)" in wide
    assert "#5b6570" not in wide
    width, height = (float(size) for size in re.search(r'viewBox="0 0 (\S+) (\S+)"', narrow).groups())
    assert width < 400
    assert height > width
