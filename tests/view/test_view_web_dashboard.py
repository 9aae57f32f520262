"""The web dashboard in a real browser: what is on the screen, and whom it talks to."""

from __future__ import annotations

import io
import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import matplotlib.image
import numpy as np
import pytest
from numpy.typing import NDArray
from view_ticks import in_order, some_events, some_ticks

from nxt_twin.twin.records import Event, Tick
from nxt_twin.view.dashboard import Dashboard, open_dashboard
from nxt_twin.view.dashboard.drawing import colours

playwright = pytest.importorskip("playwright.sync_api")

_CHROMIUM = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome")
_FLAGS = [
    "--no-sandbox",
    "--ignore-gpu-blocklist",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1",
]
_TRIES = 120
_PAUSE_MS = 1000

pytestmark = [pytest.mark.skipif(_CHROMIUM is None, reason="no Chromium"), pytest.mark.slow]


@pytest.fixture
def dashboard() -> Iterator[Dashboard]:
    opened = open_dashboard(
        view="web", save=None, ports=("a",), channels=("s1_light_raw",), title="a test's session"
    )
    yield opened
    opened.close()


@pytest.fixture
def page():
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=_CHROMIUM, args=_FLAGS)
        yield browser.new_page(viewport={"width": 900, "height": 600})
        browser.close()


def test_curves_appear_in_the_browser_and_move_on(dashboard: Dashboard, page, tmp_path: Path):
    asked: list[str] = []
    answered: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("response", lambda response: answered.append(response.url))
    ticks = some_ticks(600, ports=("a",))
    _tell(dashboard, in_order(ticks[:300], some_events()[:1]))
    _visit(page, dashboard.url)
    assert page.title() == "Rerun Viewer"
    assert page.evaluate("document.querySelector('canvas') !== null")

    wanted = (colours.PREDICTED, colours.TORQUE, colours.BOUND, colours.BATTERY, colours.LINK)
    first = _until(page, lambda picture: all(_share(picture, colour) > 0 for colour in wanted))
    assert first is not None, _keep(page, tmp_path)
    assert len(np.unique(first.reshape(-1, 3), axis=0)) > 200

    # Motor a meets its drag only now: the torque's curve has to come to stand elsewhere.
    _tell(dashboard, in_order(ticks[300:], some_events()[1:]))
    before = first
    moved = _until(page, lambda picture: _changed(picture, before, colours.TORQUE) > 0.2)
    assert moved is not None, _keep(page, tmp_path)

    assert {urlsplit(url).hostname for url in answered} == {"127.0.0.1"}
    assert any("re_viewer_bg.wasm" in url for url in asked)
    assert any("ReadMessages" in url for url in asked)


def _tell(dashboard: Dashboard, messages: list[Tick | Event]) -> None:
    for message in messages:
        if isinstance(message, Tick):
            dashboard.tick(message)
        else:
            dashboard.event(message)


def _visit(page, url: str) -> None:
    for _ in range(_TRIES):
        try:
            response = page.goto(url, timeout=60_000)
        except playwright.Error:
            page.wait_for_timeout(_PAUSE_MS)
            continue
        if response is not None and response.ok:
            return
        page.wait_for_timeout(_PAUSE_MS)
    raise AssertionError("the page was never served")


def _until(page, holds) -> NDArray[np.uint8] | None:
    """The first picture of the page for which `holds`; None where there is none for long."""
    for _ in range(_TRIES):
        picture = _look(page)
        if holds(picture):
            return picture
        page.wait_for_timeout(_PAUSE_MS)
    return None


def _look(page) -> NDArray[np.uint8]:
    shot = matplotlib.image.imread(io.BytesIO(page.screenshot(timeout=120_000)), format="png")
    return (255 * shot[..., :3]).round().astype(np.uint8)


def _near(picture: NDArray[np.uint8], colour: colours.Colour) -> NDArray[np.bool_]:
    return np.abs(picture.astype(np.int16) - np.array(colour[:3])).max(axis=2) <= 12


def _share(picture: NDArray[np.uint8], colour: colours.Colour) -> float:
    return float(_near(picture, colour).mean())


def _changed(picture: NDArray[np.uint8], before: NDArray[np.uint8], colour: colours.Colour) -> float:
    """How much of what has a colour was not there before."""
    now, then = _near(picture, colour), _near(before, colour)
    return float((now & ~then).sum() / max(now.sum(), 1))


def _keep(page, folder: Path) -> str:
    place = folder / "seen.png"
    place.write_bytes(page.screenshot())
    return f"what was seen is in {place}"
