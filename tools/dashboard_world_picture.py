"""Draw the dashboard's picture of a robot and its ghost, from a session in virtual time.

    python tools/dashboard_world_picture.py [--chromium PROGRAM] [--seconds S]

A tribot whose right wheel is smaller drives in a world. Its model is the plain castor bot, so that its ghost parts from
it until the smaller wheel is found and taken over.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import yaml
from dashboard_picture import FLAGS, FOLDER, SIZE, arguments, feed, print_events, save_small, settled, visit
from playwright.sync_api import sync_playwright

from nxt_twin.api.robots import WatchedRobot
from nxt_twin.brick.open import open_brick
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.robot.drive import drive_from_config
from nxt_twin.recording.columns import Port
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.program import MotorProgram
from nxt_twin.twin.adopt import AtOnce
from nxt_twin.twin.brick_twin import BrickTwin
from nxt_twin.twin.driver import ProgramDriver
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.session import Parts, Session
from nxt_twin.twin.settings import PACES
from nxt_twin.twin.sinks import Memory, Several
from nxt_twin.view.dashboard import open_dashboard
from nxt_twin.view.dashboard.drawing.colours import LINK
from nxt_twin.view.dashboard.scene import WorldMessage

PORTS: tuple[Port, ...] = ("b", "c")
WORLD = {
    "name": "Uneven",
    "robot": {"like": "tribot", "wheels": {"right": {"radius_mm": 26.5}}},
    "scene": {
        "start": {"at_mm": [-300, -250]},
        "floor": {
            "size_mm": [1600, 1600],
            "prints": [{"line_mm": [[-700, -250], [700, -250]], "width_mm": 20}],
        },
        "things": {
            "wall": {"box_mm": [20, 900, 150], "at_mm": [760, 0, 75], "colour": "wood"},
            "ball": {"sphere_mm": 60, "at_mm": [200, 250, 30], "mass_g": 18, "colour": "red"},
        },
    },
}
LEGS = [(1.0, 0), (3.0, 35), (0.5, 0), (2.0, -35), (0.5, 0)]
PROGRAM = MotorProgram.model_validate(
    {
        "name": "Forth and back",
        "ports": PORTS,
        "runs": [{"name": "legs", "segments": [{"duration_s": s, "power_pct": power} for s, power in LEGS]}],
    }
)


def main() -> None:
    """Write docs/pictures/dashboard-world.png and print what the session said."""
    chosen = arguments(__doc__, 11.0)
    memory, world = _session(chosen.seconds)
    print_events(memory)
    _photograph(chosen.chromium, memory, world, FOLDER / "dashboard-world.png")


def _session(seconds: float) -> tuple[Memory, list[WorldMessage]]:
    clock, memory = VirtualClock(), Memory(100_000)
    world: list[WorldMessage] = []
    robot = WatchedRobot(drive_from_config(load_plant_config("castor_bot")), memory.event, AtOnce())
    robot.show_in(world.append)
    plant = plant_from_config(load_plant_config("nxt_motor"), "power_pct")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "uneven.yaml"
        file.write_text(yaml.safe_dump(WORLD), encoding="utf-8")
        parts = Parts(
            open_brick=lambda: open_brick(f"mock:?world={file}", clock, {"mock": robot.open}),
            clock=clock,
            twin=BrickTwin(dict.fromkeys(PORTS, plant)),
            sink=Several([memory, robot]),
            plan=Plan(sensors={4: "ultrasonic"}),
            pace=PACES["usb"],
            driver=ProgramDriver(PROGRAM),
            recorder=None,
            adopter=None,
        )
        Session(parts).run(seconds)
    return memory, world


def _photograph(program: str, memory: Memory, world: list[WorldMessage], place: Path) -> None:
    title = "a robot with a smaller right wheel"
    dashboard = open_dashboard(
        view="web", save=None, ports=PORTS, channels=["s4_ultrasonic_cm"], title=title, world=True
    )
    try:
        for message in world:
            dashboard.show(message)
        feed(dashboard, memory)
        with sync_playwright() as driver:
            browser = driver.chromium.launch(executable_path=program, args=FLAGS)
            page = browser.new_page(viewport=SIZE, color_scheme="dark")  # type: ignore[arg-type]
            visit(page, dashboard.url)
            save_small(settled(page, place, LINK), place)
            browser.close()
    finally:
        dashboard.close()


if __name__ == "__main__":
    main()
