"""The example package, really installed: its effect takes part in everything."""

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

from nxt_twin.physics.layout import layout
from nxt_twin.physics.library import library
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.recorded import signals_of
from nxt_twin.physics.simulate import Simulator, free_job
from nxt_twin.physics.start import at_rest
from nxt_twin.physics.stepper import Stepper
from nxt_twin.recording.case import read_case

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "user_effect"
OFFLINE = ("--quiet", "--no-index", "--no-deps", "--no-build-isolation", "--disable-pip-version-check")
pytestmark = [pytest.mark.usefixtures("installed"), pytest.mark.slow]
TRUE = {
    "kind": "dc_motor",
    "resistance_ohm": 7.9,
    "torque_constant_nm_per_a": 0.48,
    "back_emf_v_s_per_rad": 0.48,
    "coulomb_friction_nm": 0.010,
    "viscous_friction_nm_s_per_rad": 0.0021,
    "inertia_kg_m2": 1.3e-3,
    "supply_v": 8.0,
    "effects": {"centrifugal_brake": {"brake_nm_s2_per_rad2": 9e-4, "engage_speed_rad_s": 7.0}},
}


def forget():
    library.cache_clear()
    layout.cache_clear()


@pytest.fixture(scope="module")
def maker():
    spec = importlib.util.spec_from_file_location("user_effect_make_case", EXAMPLE / "make_case.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """The package in a folder of its own, by pip, on the path for these tests."""
    place = tmp_path_factory.mktemp("site")
    subprocess.run(
        [sys.executable, "-m", "pip", "install", *OFFLINE, "--target", str(place), str(EXAMPLE)],
        check=True,
    )
    patch = pytest.MonkeyPatch()
    patch.syspath_prepend(place)
    forget()
    yield place
    patch.undo()
    forget()


@pytest.fixture(scope="module")
def case(maker, tmp_path_factory):
    folder = tmp_path_factory.mktemp("braked")
    maker.write_case(folder)
    return read_case(folder)


def test_its_page_says_what_its_commands_say(installed, tmp_path, monkeypatch):
    """They diagnose with every effect. The kernel that they compile serves the tests below, and later runs."""
    monkeypatch.syspath_prepend(EXAMPLE.parents[1] / "tools")
    monkeypatch.setenv("PYTHONPATH", f"{EXAMPLE.parents[1]}{os.pathsep}{installed}")
    import tutorials

    shutil.copytree(EXAMPLE, tmp_path, dirs_exist_ok=True)
    page = (EXAMPLE / "README.md").read_text(encoding="utf-8")
    assert sum(not step.file for step in tutorials.steps(page)) == 3
    instead = {"pip install --quiet --no-deps .": f"ls {installed}/centrifugal_brake.py > installed"}
    assert list(tutorials.played(page, tmp_path, instead)) == []


def test_the_kernel_moves_as_the_example_s_own_simulation(case):
    plant = plant_from_config(TRUE, "power_pct")
    run = signals_of(case.recordings[0], "a")
    run.command_supply_v[:] = 8.0
    with Simulator(plant.layout, workers=1) as simulator:
        angle = simulator.trace(plant, free_job(run, at_rest(run)))["predicted"]
    assert np.degrees(np.abs(angle - run.measured)).max() < 2.5
    assert np.ptp(run.measured) > 6.0


def test_the_effect_goes_through_a_plant_file():
    plant = plant_from_config(TRUE, "power_pct")
    again = plant_from_config(yaml.safe_load(yaml.safe_dump(plant.to_config())), "power_pct")
    assert again == plant


def test_a_stepped_plant_is_braked():
    free = {key: value for key, value in TRUE.items() if key != "effects"}
    stepper = Stepper([plant_from_config(config, "power_pct") for config in (TRUE, free)])
    for _ in range(1000):
        stepper.step(np.ones(2), np.zeros(2, dtype=np.int64), 8.0, 1e-3)
    braked, unbraked = stepper.speed
    torque = 0.48 * (8.0 - 0.48 * braked) / 7.9 - 0.010 - 0.0021 * braked - 9e-4 * (braked**2 - 49.0)
    assert torque == pytest.approx(0.0, abs=1e-6)
    assert unbraked > braked + 1.0


def test_both_sides_name_the_confusion():
    assert "centrifugal_brake" in library()["quadratic_drag"].confusable_with
