"""Where compiled kernels are kept; each test compiles one entry point, of few effects, in a folder of its own."""

import inspect
import os
from dataclasses import replace

import numpy as np
import pytest
from physics_samples import NXT

from nxt_twin.physics import abreast
from nxt_twin.physics.assemble import source_outline
from nxt_twin.physics.base.dc_motor import DC_MOTOR
from nxt_twin.physics.base.rigid_body import RIGID_BODY
from nxt_twin.physics.effects import BUILT_IN
from nxt_twin.physics.kernel import CACHE_VARIABLE, kernel
from nxt_twin.physics.layout import Layout, layout
from nxt_twin.physics.library import library
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.stepper import Stepper


@pytest.fixture
def turned_deg(monkeypatch):
    """How far a motor turns in 50 ms, by a kernel that this process has not loaded yet."""
    monkeypatch.setattr("nxt_twin.physics.library.BUILT_IN", [e for e in BUILT_IN if e.plain])
    forget()
    yield _turned_deg
    monkeypatch.undo()
    forget()


def forget():
    library.cache_clear()
    layout.cache_clear()


def _turned_deg():
    plant = replace(plant_from_config(NXT, "power_pct"), layout=Layout(DC_MOTOR, "motor"))
    stepper = Stepper([plant])
    for _ in range(50):
        stepper.step(np.ones(1), np.zeros(1, dtype=np.int64), 8.0, 1e-3)
    return float(np.degrees(stepper.angle[0]))


def test_a_cache_folder_that_is_not_there_yet_is_made_and_filled(turned_deg, tmp_path, monkeypatch):
    folder = tmp_path / "not" / "there"
    monkeypatch.setenv(CACHE_VARIABLE, str(folder))
    assert 5.0 < turned_deg() < 25.0
    assert [path.suffix for path in folder.iterdir() if path.is_file()] == [".py"]


@pytest.mark.slow
def test_without_any_folder_to_write_the_kernel_still_works(turned_deg, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "file" / "below"))
    assert 5.0 < turned_deg() < 25.0
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


@pytest.mark.skipif(os.geteuid() == 0, reason="nothing is read-only for root")
def test_a_read_only_folder_is_left_alone(turned_deg, tmp_path, monkeypatch):
    folder = tmp_path / "locked"
    folder.mkdir(mode=0o500)
    monkeypatch.setenv(CACHE_VARIABLE, str(folder))
    assert 5.0 < turned_deg() < 25.0
    assert list(folder.iterdir()) == []


def test_the_same_physics_shares_one_source_and_other_physics_does_not(tmp_path, monkeypatch):
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path))
    for base, frame in [
        (DC_MOTOR, "motor"),
        (DC_MOTOR, "motor"),
        (RIGID_BODY, "rotary"),
        (RIGID_BODY, "linear"),
    ]:
        kernel(Layout(base, frame))
    names = sorted(path.name for path in tmp_path.glob("*.py"))
    assert [name.rsplit("_", 1)[0] for name in names] == [
        "dc_motor_motor",
        "rigid_body_linear",
        "rigid_body_rotary",
    ]


def test_a_kernel_that_the_cache_holds_is_not_written_again(tmp_path, monkeypatch):
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path))
    plan = Layout(DC_MOTOR, "motor")
    kernel.__wrapped__(plan)
    monkeypatch.setattr("nxt_twin.physics.kernel.source", lambda _: pytest.fail("written again"))
    kernel.__wrapped__(plan)


@pytest.mark.parametrize(("of", "changed"), [("abreast.LANES", 4), ("assemble.SETTLING", 7)])
def test_a_change_of_what_writes_a_kernel_changes_its_name(of, changed, tmp_path, monkeypatch):
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path))
    plan = Layout(DC_MOTOR, "motor")
    kernel.__wrapped__(plan)
    monkeypatch.setattr(f"nxt_twin.physics.{of}", changed)
    kernel.__wrapped__(plan)
    assert len(list(tmp_path.glob("*.py"))) == 2


def test_the_code_that_rewrites_runs_is_part_of_a_kernels_name():
    assert inspect.getsource(abreast) in source_outline(Layout(DC_MOTOR, "motor"))


def test_plants_at_rest_load_no_kernel(tmp_path, monkeypatch):
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path))
    plant = replace(plant_from_config(NXT, "power_pct"), layout=Layout(DC_MOTOR, "motor"))
    stepper = Stepper([plant], ready=False)
    stepper.step(np.zeros(1), np.zeros(1, dtype=np.int64), 8.0, 1e-3)
    assert list(tmp_path.iterdir()) == []
