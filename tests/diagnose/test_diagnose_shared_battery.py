"""Motors of one brick that move at once: what the others draw is in no motor's own current."""

import numpy as np
import pytest
import yaml

from nxt_twin.brick.brick import Brick
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.mock.body.battery import DEFAULT_RESISTANCE_OHM
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.start import open_mock_link
from nxt_twin.recording.case import read_case
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.program import MotorProgram, Run, Segment
from nxt_twin.recording.stream import RecordingWriter
from nxt_twin.twin.driver import ProgramDriver, excitation
from nxt_twin.twin.logbook import Logbook, columns_to_fill
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.settings import PACES

PORTS = ("a", "b", "c")
SECONDS = 14.0


class Apart:
    """Each motor by a program of its own."""

    def __init__(self, programs):
        self.ports = tuple(programs)
        self._drivers = {port: ProgramDriver(program) for port, program in programs.items()}

    def at(self, time_s, counts):
        return {
            port: driver.at(time_s, {port: counts[port]} if port in counts else {})[port]
            for port, driver in self._drivers.items()
        }


def steps(port, seed, mode):
    """Powers at random, each for half a second or more."""
    rng = np.random.default_rng(seed)
    segments = [Segment(duration_s=0.5)] + [
        Segment(duration_s=rng.uniform(0.5, 1.2), power_pct=int(rng.integers(-100, 101)), mode=mode)
        for _ in range(30)
    ]
    return MotorProgram(name="steps", ports=(port,), runs=(Run(name="steps", segments=tuple(segments)),))


DRIVERS = {
    "alike": lambda: ProgramDriver(excitation(PORTS)),
    "apart": lambda: Apart({port: steps(port, seed, "drive") for seed, port in enumerate(PORTS)}),
    "floating": lambda: Apart(
        {p: steps(p, seed, "float" if p == "c" else "drive") for seed, p in enumerate(PORTS)}
    ),
    "two": lambda: Apart({port: steps(port, seed, "drive") for seed, port in enumerate(PORTS[:2])}),
}


@pytest.fixture(scope="module")
def cases(tmp_path_factory):
    """A folder for each way to drive, its recording made by the mock as it comes: in virtual time."""
    return {name: _recorded(tmp_path_factory.mktemp(name), make()) for name, make in DRIVERS.items()}


def _recorded(folder, driver):
    clock, path = VirtualClock(), folder / "run.csv"
    with (
        Brick(open_mock_link(clock, seed=3, profile="usb"), clock) as brick,
        RecordingWriter(path, columns_to_fill(PORTS, {})) as writer,
    ):
        logbook = Logbook(brick, clock, PORTS, Plan(period_s=0.01), writer, driver, PACES["usb"])
        logbook.keep(SECONDS)
    logbook.row_lags.write_beside(path)
    return folder


def _diagnosed(folder, port, **effects):
    plant = {**load_plant_config("nxt_motor"), "effects": effects}
    keys = {"plant": plant, "recordings": ["run.csv"], "port": port}
    (folder / "case.yaml").write_text(yaml.safe_dump(keys))
    return diagnose(read_case(folder)).diagnosis


@pytest.mark.slow_variants
@pytest.mark.parametrize(("how", "ports"), [("alike", "a"), ("apart", "a"), ("floating", "a")])
def test_the_battery_that_all_share_is_named_with_its_own_resistance(cases, how, ports):
    for port in ports:
        found = _diagnosed(cases[how], port)
        assert found.verdict == "explained"
        sag = {effect.id: effect for effect in found.effects}["battery_sag"].params["internal_resistance_ohm"]
        assert sag.value == pytest.approx(DEFAULT_RESISTANCE_OHM, rel=0.2)
        assert abs(sag.value - DEFAULT_RESISTANCE_OHM) < 2.0 * sag.std


def test_where_the_battery_hardly_matters_to_a_simulation_it_may_go_unnamed(cases):
    found = _diagnosed(cases["two"], "b")
    assert found.verdict != "unexplained"
    assert {effect.id for effect in found.effects} <= {"battery_sag"}
    assert found.fit.improved < 1.2 * found.fit.floor


@pytest.mark.slow_variants
@pytest.mark.parametrize(
    ("how", "ports"),
    [("alike", "b"), ("floating", "b"), ("two", "a")],
    ids=["alike", "floating", "two"],
)
def test_with_the_battery_in_the_model_nothing_is_missing(cases, how, ports):
    sag = {"internal_resistance_ohm": DEFAULT_RESISTANCE_OHM}
    for port in ports:
        found = _diagnosed(cases[how], port, battery_sag=sag)
        assert found.verdict != "unexplained"
        assert {effect.id for effect in found.effects} <= {"command_delay"}
        assert found.fit.improved < 1.2 * found.fit.floor
