"""Draw the dashboard's pictures from a real run: a mock brick, its twin, and the web viewer without a screen.

    python tools/dashboard_picture.py [--chromium PROGRAM] [--seconds S]

The twin watches a mock brick whose motor on A carries a weight that the model does not know. It adopts the
result of a diagnosis, as with --adopt. Its messages go to the dashboard as in any session; a browser without
a window loads the dashboard and takes the picture.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import final

import matplotlib.image
import numpy as np
import yaml
from playwright.sync_api import Error, Page, sync_playwright

from nxt_twin.api.openers import OPENERS
from nxt_twin.brick.open import open_brick
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.columns import Port
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.twin.adopt import Adopter, AtOnce
from nxt_twin.twin.brick_twin import BrickTwin
from nxt_twin.twin.driver import ProgramDriver, excitation
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.sensor_twin import PortSensor, SensorTwin
from nxt_twin.twin.session import Parts, Session
from nxt_twin.twin.settings import PACES
from nxt_twin.twin.sinks import Memory, Several
from nxt_twin.twin.verdict import Seen, verdict
from nxt_twin.view.dashboard import Dashboard, open_dashboard
from nxt_twin.view.dashboard.drawing.colours import LINK, TORQUE
from nxt_twin.view.dashboard.drawing.layout import FOCUS
from nxt_twin.view.live_report import Keeper, LinkedDiagnosis, write_live_report

PORTS: tuple[Port, ...] = ("a", "b", "c")
SENSORS: dict[int, PortSensor] = {1: "touch", 3: "light", 4: "ultrasonic"}
FOLDER = Path(__file__).resolve().parents[1] / "docs" / "pictures"
SIZE = {"width": 1500, "height": 900}
FOCUS_SIZE = {"width": 920, "height": 560}
FLAGS = [
    "--no-sandbox",
    "--ignore-gpu-blocklist",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1",
]
COLOURS = 256
LOAD_NM = -0.045


def main() -> None:
    """Write docs/pictures/dashboard-*.png and print what the session said."""
    chosen = arguments(__doc__, 23.5)
    memory, told = _session(chosen.seconds)
    print_events(memory)
    FOLDER.mkdir(parents=True, exist_ok=True)
    for tab, name in ((FOCUS, "dashboard"), (0, "dashboard-motor"), (len(PORTS), "dashboard-sensors")):
        _photograph(chosen.chromium, memory, tab, FOLDER / f"{name}.png")
    _photograph_report(chosen.chromium, told, FOLDER / "live-report.png")


def arguments(text: str | None, seconds: float) -> argparse.Namespace:
    """A browser's program and a session's length, s; ends the program where there is no browser."""
    words = argparse.ArgumentParser(description=(text or "").partition("\n")[0])
    words.add_argument("--chromium", default=shutil.which("chromium") or shutil.which("google-chrome"))
    words.add_argument("--seconds", type=float, default=seconds)
    chosen = words.parse_args()
    if chosen.chromium is None:
        sys.exit("there is no Chromium on this machine; name one with --chromium")
    return chosen


def print_events(memory: Memory) -> None:
    """Print the events of a session, a line each."""
    for event in memory.events:
        print(f"{event.time_s:6.1f} s  {event.words}")


@final
@dataclass(frozen=True)
class Told:
    """The words and polls that a session's report needs."""

    kept: Keeper
    sentence: str
    findings: list[LinkedDiagnosis]


def _session(seconds: float) -> tuple[Memory, Told]:
    """All that a session in virtual time says, and its report's part; each machine gets equal ones."""
    clock = VirtualClock()
    plant = plant_from_config(load_plant_config("nxt_motor"), "power_pct")
    twin = BrickTwin(dict.fromkeys(PORTS, plant))
    memory, kept, adopter = Memory(100_000), Keeper(), Adopter(AtOnce())
    with tempfile.TemporaryDirectory() as folder:
        world = Path(folder) / "world.yaml"
        world.write_text(yaml.safe_dump(_world()), encoding="utf-8")
        parts = Parts(
            open_brick=lambda: open_brick(f"mock:?world={world}&profile=usb&seed=3", clock, OPENERS),
            clock=clock,
            twin=twin,
            sink=Several([memory, kept]),
            plan=Plan(sensors=SENSORS),  # type: ignore[arg-type]
            pace=PACES["usb"],
            driver=ProgramDriver(excitation(PORTS)),
            recorder=None,
            adopter=adopter,
        )
        session = Session(parts)
        session.run(seconds)
    diverging = [port for port, monitor in session.monitors.items() if monitor.diverging]
    seen = Seen(session.polls, session.lasted_s, session.unseen_s)
    findings = [
        LinkedDiagnosis(port, each.sentence, f"live-{port}-{number}.html")
        for number, (port, each) in enumerate(adopter.diagnoses, start=1)
    ]
    return memory, Told(kept, verdict(memory.events, diverging, seen).sentence, findings)


def _world() -> dict[str, object]:
    loaded = {
        **load_plant_config("nxt_motor"),
        "effects": {"constant_load": {"load_torque_nm": LOAD_NM}},
    }
    return {
        "name": "Loaded",
        "motors": {"a": loaded, "b": "nxt_motor", "c": "nxt_motor"},
        "sensors": {
            1: {"kind": "touch", "pressed": {"points": [[0, 0], [2, 1], [2.5, 0], [5, 0]], "repeat": True}},
            3: {"kind": "light", "raw": 650, "lit_raw": 480, "noise_raw": 2.5},
            4: {
                "kind": "ultrasonic",
                "distance_cm": {"points": [[0, 120], [5, 30], [10, 120]], "between": "line", "repeat": True},
            },
        },
    }


def _photograph(program: str, memory: Memory, tab: int, place: Path) -> None:
    channels = [SensorTwin(slot, kind).column for slot, kind in SENSORS.items()]  # type: ignore[arg-type]
    dashboard = open_dashboard(
        view="web", save=None, ports=PORTS, channels=channels, title="mock brick, loaded motor A", tab=tab
    )
    try:
        feed(dashboard, memory)
        with sync_playwright() as driver:
            browser = driver.chromium.launch(executable_path=program, args=FLAGS)
            size = FOCUS_SIZE if tab == FOCUS else SIZE
            page = browser.new_page(viewport=size, color_scheme="dark")  # type: ignore[arg-type]
            visit(page, dashboard.url)
            save_small(settled(page, place, TORQUE if tab == FOCUS else LINK), place)
            browser.close()
    finally:
        dashboard.close()


def feed(dashboard: Dashboard, memory: Memory) -> None:
    """Hand the session over, as fast as the dashboard takes it."""
    for event in memory.events:
        dashboard.event(event)
    for tick in memory.ticks:
        while dashboard.waiting > 500:
            time.sleep(0.05)
        dashboard.tick(tick)
    while dashboard.waiting:
        time.sleep(0.1)
    time.sleep(3.0)


def visit(page: Page, url: str) -> None:
    """Load the dashboard's page as soon as it is served."""
    for _ in range(60):
        try:
            page.goto(url, timeout=60_000)
        except Error:
            time.sleep(0.5)
        else:
            return
    sys.exit("the dashboard's page was never served")


def settled(page: Page, place: Path, curve: tuple[int, ...]) -> Path:
    """Photograph until the curve of that colour is there and two pictures in a row are alike: all is drawn."""
    before, alike = np.zeros(0), 0
    for _ in range(40):
        page.wait_for_timeout(2500)
        page.screenshot(path=place, timeout=180_000)
        now = matplotlib.image.imread(place)[..., :3]
        drawn = (np.abs(now - np.array(curve[:3]) / 255).max(axis=2) < 0.05).sum() > 100
        same = before.shape == now.shape and float(np.abs(now - before).mean()) < 1e-4
        alike = alike + 1 if same and drawn else 0
        if alike >= 2:
            return place
        before = now
    sys.exit("the dashboard was never drawn to its end; is the machine busy?")


def _photograph_report(program: str, told: Told, place: Path) -> None:
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        report = write_live_report(
            Path(folder),
            told.kept,
            title="mock brick, loaded motor A",
            sentence=told.sentence,
            findings=told.findings,
        )
        browser = driver.chromium.launch(executable_path=program, args=FLAGS)
        page = browser.new_page(viewport={"width": 1100, "height": 1480})
        page.goto(report.as_uri())
        page.screenshot(path=place)
        browser.close()
    save_small(place, place)


def save_small(source: Path, place: Path) -> None:
    """Write a picture with few colours, which is a fraction of the size."""
    from PIL import Image

    with Image.open(source) as picture:
        picture.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE).save(place, optimize=True)
    print(f"{place.name}: {place.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
