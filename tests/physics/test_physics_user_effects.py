"""Effects that another package brings along, by a real entry point of an installed distribution."""

import numpy as np
import pytest
from physics_samples import NXT
from scipy.integrate import solve_ivp

from nxt_twin.errors import PlantError
from nxt_twin.physics.assemble import source
from nxt_twin.physics.effects import BUILT_IN
from nxt_twin.physics.kernel import CACHE_VARIABLE
from nxt_twin.physics.layout import Slot, layout
from nxt_twin.physics.library import library
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.stepper import Stepper

MAGNET = """
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.parameter import NUMBER, Parameter

def _share(heat):
    return 1.0 / (1.0 + heat)

def _brake(speed, strength, heat):
    return strength * abs(speed) * _share(heat)

def _warm(heat, before, after, step_s):
    return heat + step_s * 0.5 * (before + after) ** 2 / 100.0

BRAKE = Effect(
    id="eddy_brake",
    name="eddy-current brake",
    equation="a made-up law with a state",
    equation_of="torque_balance",
    shows=("high_speed",),
    parameters=(
        Parameter("strength_nm_s2_per_rad2", "strength", "N·m·s²/rad²", NUMBER, (1e-3,), 0.0, 1.0),
    ),
    terms={"damping": _brake, "advance": _warm},
    states=("heat",),
)
SAME_AGAIN = Effect("stiction", "again", "", "timing", (), BRAKE.parameters, {})

def _greedy(strength, weather):
    return strength

GREEDY = Effect("greedy", "greedy", "", "torque_balance", (), BRAKE.parameters, {"torque": _greedy})
NAMELESS = Effect("nameless", "", "", "torque_balance", (), BRAKE.parameters, {"torque": lambda strength: strength})
NO_EFFECT = 3
"""


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Install the package `eddy_magnet` with one entry point, for this test."""

    def with_entry_point(target):
        (tmp_path / "eddy_magnet.py").write_text(MAGNET)
        info = tmp_path / "eddy_magnet-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text("Metadata-Version: 2.1\nName: eddy-magnet\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[nxt_twin.effects]\nbrake = {target}\n")
        monkeypatch.syspath_prepend(tmp_path)
        forget()

    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "kernels"))
    yield with_entry_point
    monkeypatch.undo()
    forget()


def forget():
    library.cache_clear()
    layout.cache_clear()


def test_a_package_s_effect_runs_in_the_kernel_by_its_own_law(install, monkeypatch):
    monkeypatch.setattr(
        "nxt_twin.physics.library.BUILT_IN", [e for e in BUILT_IN if e.plain]
    )  # fewer to compile
    install("eddy_magnet:BRAKE")
    config = {**NXT, "effects": {"eddy_brake": {"strength_nm_s2_per_rad2": 3e-3}}}
    plant = plant_from_config({k: v for k, v in config.items() if k != "inductance_h"}, "power_pct")
    assert plant.values[Slot("eddy_brake", "strength")] == 3e-3
    stepper = Stepper([plant])
    for _ in range(1000):
        stepper.step(np.ones(1), np.zeros(1, dtype=np.int64), 8.0, 1e-3)

    def rates(_, x):
        _, speed, heat = x
        drive = 0.4908 * (8.0 - 0.4908 * speed) / 7.6
        brake = 3e-3 * speed * abs(speed) / (1.0 + heat)
        torque = drive - 1.92e-3 * speed - 8.45e-3 - brake
        return speed, torque / 1.2e-3, 2.0 * speed**2 / 100.0

    expected = solve_ivp(rates, (0.0, 1.0), [0.0, 0.0, 0.0], rtol=1e-9, atol=1e-9).y[:, -1]
    assert stepper.angle[0] == pytest.approx(expected[0], rel=1e-3)
    assert stepper.speed[0] == pytest.approx(expected[1], rel=1e-3)


def test_a_package_s_effect_is_in_every_list_and_is_written_to_plant_files(install):
    install("eddy_magnet:BRAKE")
    assert "eddy_brake" in library()
    for kind, frame in [("dc_motor", "motor"), ("rigid_body", "rotary"), ("rigid_body", "linear")]:
        plan = layout(kind, frame)
        assert plan.effects[-1].id == "eddy_brake"
        assert "_eddy_brake_damping(" in source(plan)
    plant = plant_from_config(NXT, "power_pct").with_effect("eddy_brake", {"strength": 2e-3})
    assert plant.to_config()["effects"] == {"eddy_brake": {"strength_nm_s2_per_rad2": 2e-3}}


def test_an_uninstalled_package_s_effect_is_unknown():
    with pytest.raises(PlantError, match="no effect 'eddy_brake'"):
        plant_from_config({**NXT, "effects": {"eddy_brake": {"strength_nm_s2_per_rad2": 2e-3}}}, "power_pct")


def test_an_entry_point_that_names_no_effect_is_refused_by_its_name(install):
    install("eddy_magnet:NO_EFFECT")
    with pytest.raises(
        PlantError, match="entry point brake = eddy_magnet:NO_EFFECT: does not name an Effect"
    ):
        library()


def test_an_id_that_is_taken_is_refused(install):
    install("eddy_magnet:SAME_AGAIN")
    with pytest.raises(PlantError, match="stiction is taken"):
        library()


def test_a_lambda_is_refused_as_a_term(install):
    install("eddy_magnet:NAMELESS")
    with pytest.raises(PlantError, match="effect nameless: its torque term is a lambda"):
        source(layout("rigid_body", "rotary"))


def test_a_term_that_asks_for_an_unknown_quantity_is_refused_with_what_there_is(install):
    install("eddy_magnet:GREEDY")
    with pytest.raises(PlantError) as caught:
        source(layout("rigid_body", "rotary"))
    line = str(caught.value)
    assert "effect greedy" in line
    assert "torque term asks for 'weather'" in line
    assert "angle" in line
    assert "strength" in line
