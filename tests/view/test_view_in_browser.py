"""Pages in a real browser: nothing sticks out of a phone's screen, and no word is cut, written over or faint."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

import pytest
import view_samples as samples
from view_ticks import some_events, some_ticks

from nxt_twin.fleet.findings.found import findings_in
from nxt_twin.paper.reproduction import reproduce
from nxt_twin.view.changes_report import render_changes
from nxt_twin.view.fleet_page import render_fleet_page
from nxt_twin.view.live_report import Keeper, LinkedDiagnosis, render_live_report
from nxt_twin.view.paper_page import render_paper_page
from nxt_twin.view.report import render_report

sys.path.insert(0, str(Path(__file__).parents[1] / "fleet"))
from fleet_tables import changed_fleet, write_table

playwright = pytest.importorskip("playwright.sync_api")

CHROMIUM = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome")
PHONE, DESK = {"width": 390, "height": 844}, {"width": 1280, "height": 900}

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium is here to show the pages to")

SIDEWAYS_PX = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
SCROLLED = """[...document.querySelectorAll('figure, .scroll')]
    .filter(each => each.scrollWidth > each.clientWidth + 1).map(each => each.textContent.trim().slice(0, 60))"""
CUT = """[...document.querySelectorAll('svg')].flatMap(svg => {
    const page = svg.getBoundingClientRect();
    return [...svg.querySelectorAll('text')].filter(word => {
        const at = word.getBoundingClientRect();
        return at.width && (at.left < page.left - 1 || at.right > page.right + 1
            || at.top < page.top - 1 || at.bottom > page.bottom + 1);
    }).map(word => word.textContent);
})"""
WRITTEN_OVER = """[...document.querySelectorAll('svg')].flatMap(svg => {
    const words = [...svg.querySelectorAll('text')].map(word => [word.textContent, word.getBoundingClientRect()])
        .filter(([, at]) => at.width);
    return words.flatMap(([one, a], n) => words.slice(n + 1).filter(([, b]) =>
        Math.min(a.right, b.right) - Math.max(a.left, b.left) > 2
        && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 0.35 * Math.min(a.height, b.height))
        .map(([other]) => `${one} / ${other}`));
})"""

FAINT = """(() => {
    const parts = colour => (colour.match(/[\\d.]+/g) || [0, 0, 0, 0]).map(Number);
    const light = colour => parts(colour).slice(0, 3).map(x => x / 255)
        .map(x => x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4)
        .reduce((sum, x, n) => sum + x * [0.2126, 0.7152, 0.0722][n], 0);
    const behind = each => {
        for (let at = each; at; at = at.parentElement) {
            const colour = getComputedStyle(at).backgroundColor, [, , , alpha = 1] = parts(colour);
            if (alpha > 0) return colour;
        }
        return 'rgb(255, 255, 255)';
    };
    const words = [...document.querySelectorAll('main *')].filter(each => each.getBoundingClientRect().width
        && [...each.childNodes].some(node => node.nodeType === 3 && node.textContent.trim()));
    return words.filter(each => {
        const drawn = each.ownerSVGElement, style = getComputedStyle(each);
        const [high, low] = [light(drawn ? style.fill : style.color), light(behind(each))].sort((a, b) => b - a);
        return (high + 0.05) / (low + 0.05) < (drawn ? 3 : 4.5);
    }).map(each => each.textContent.trim().slice(0, 40));
})()"""
"""Words of too little contrast: below 4.5, or below 3 in a picture, where a name has the colour of its curve."""


def live() -> str:
    kept = Keeper(8000)
    for tick in some_ticks(450):
        kept.tick(tick)
    for event in some_events():
        kept.event(event)
    found = LinkedDiagnosis("a", "The model leaves out viscous friction.", "live-a-1.html")
    return render_live_report(kept, title="mock:", sentence="port A differs", findings=[found])


def fleet(folder: Path) -> str:
    return render_fleet_page(
        findings_in(write_table(folder / "fleet.parquet", changed_fleet())), "fleet.parquet"
    )


PAGES = {
    "motor": lambda _: render_report(samples.explained(runs=2)),
    "adequate": lambda _: render_report(samples.brief(samples.adequate())),
    "unexplained": lambda _: render_report(samples.brief(samples.unexplained(helped=True))),
    "stale": lambda _: render_report(samples.brief(samples.with_stale_samples())),
    "sensor": lambda _: render_report(samples.of_sensor()),
    "robot": lambda _: render_report(samples.of_robot()),
    "changed": lambda _: render_changes(samples.changes()),
    "live": lambda _: live(),
    "fleet": fleet,
    "paper": lambda _: render_paper_page(reproduce()),
}


@pytest.fixture(scope="module")
def browser():
    with playwright.sync_playwright() as driver:
        opened = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield opened
        opened.close()


@pytest.mark.parametrize("name", PAGES)
def test_a_page_fits_a_phone_and_each_word_can_be_read(name, browser, tmp_path):
    place = tmp_path / "page.html"
    place.write_text(PAGES[name](tmp_path).replace("<details>", "<details open>"), encoding="utf-8")
    for size in (PHONE, DESK):
        page = browser.new_page(viewport=size)
        page.goto(place.as_uri())
        assert page.evaluate(SIDEWAYS_PX) == 0
        assert page.evaluate(SCROLLED) == []
        assert page.evaluate(CUT) == []
        assert page.evaluate(WRITTEN_OVER) == []
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme)
            assert page.evaluate(FAINT) == []
        page.close()
