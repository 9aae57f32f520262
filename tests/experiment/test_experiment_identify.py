import json
from collections.abc import Mapping
from pathlib import Path
from random import Random

import numpy as np
import pytest
import yaml
from experiment_bench import bench_for, new_folder, small, surroundings

from nxt_twin.experiment.combine import combined, propagated
from nxt_twin.experiment.errors import ExperimentError
from nxt_twin.experiment.identified import Identified, normal_value
from nxt_twin.experiment.identify import carry_out, conclude
from nxt_twin.experiment.plan import Experiment
from nxt_twin.experiment.posterior import weighed
from nxt_twin.experiment.standin.rig import Echo, Transducers, place_transducers, place_ultrasonic
from nxt_twin.experiment.standin.workbench import Workbench, workbench
from nxt_twin.mock.body.world import World
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.case import read_case
from nxt_twin.sensors.ultrasonic import UltrasonicParameters

MOTOR = {
    "kind": "dc_motor",
    "resistance_ohm": 7.1,
    "inductance_h": 4.88e-3,
    "torque_constant_nm_per_a": 0.478,
    "back_emf_v_s_per_rad": 0.478,
    "coulomb_friction_nm": 0.012,
    "viscous_friction_nm_s_per_rad": 1.5e-3,
    "inertia_kg_m2": 1.35e-3,
}
DISC = [{"name": "bare"}, {"name": "disc", "added_inertia_kg_m2": 1.6e-3, "added_inertia_std_kg_m2": 1e-5}]


def identify(experiment: Experiment, path: Path, bench: Workbench | None = None) -> Identified:
    folder = new_folder(path, experiment)
    carry_out(experiment, folder, surroundings(bench or bench_for(experiment), experiment))
    return conclude(experiment, folder)


def motor_bench(**effects: Mapping[str, float]) -> Workbench:
    motor = {**MOTOR, "effects": effects}
    world = {"motors": {"a": motor}, "battery": {"voltage_v": 8.1, "internal_resistance_ohm": 0.0}}
    return workbench(World.model_validate(world))


def near(identified: Identified, name: str, truth: float, stds: float = 4.0) -> bool:
    value = identified.value(name)
    return abs(value.value - truth) < stds * value.std


def test_a_motor_without_an_anchor_gives_ratios_and_says_so(tmp_path: Path) -> None:
    found = identify(small("motor_identification"), tmp_path, motor_bench())
    inertia = MOTOR["inertia_kg_m2"]
    assert near(found, "torque_constant_nm_per_a", 0.478)
    assert near(found, "resistance_times_inertia", 7.1 * inertia)
    assert near(found, "viscous_over_inertia", 1.5e-3 / inertia)
    assert near(found, "coulomb_over_inertia", 0.012 / inertia)
    assert found.value("torque_constant_nm_per_a").rests_on == ""
    assert "7.6 Ω" in found.value("inertia_kg_m2").rests_on
    assert found.value("inertia_kg_m2").std / found.value("inertia_kg_m2").value > 0.05
    assert "scale together" in found.notes[0]


def test_a_disc_of_known_inertia_tells_resistance_and_inertia_apart(tmp_path: Path) -> None:
    found = identify(small("motor_identification", loads=DISC), tmp_path, motor_bench())
    for name in ("resistance_ohm", "inertia_kg_m2", "coulomb_friction_nm", "viscous_friction_nm_s_per_rad"):
        assert near(found, name, MOTOR[name])
        assert "added inertia" in found.value(name).rests_on
    assert found.value("resistance_ohm").std < 0.5
    # Two sets of runs do not make one battery's reading any better.
    constant = found.value("torque_constant_nm_per_a")
    assert constant.std / constant.value > 0.013848 / 12**0.5 / 8.1


def test_a_disc_that_was_not_there_is_noticed(tmp_path: Path) -> None:
    experiment = small("motor_identification", loads=DISC)
    folder = new_folder(tmp_path, experiment)
    around = surroundings(motor_bench(), experiment)
    lazy = type(around)(around.brick, around.clock, {}, lambda _: "")
    carry_out(experiment, folder, lazy)
    with pytest.raises(ExperimentError, match="no slower"):
        conclude(experiment, folder)


def test_the_papers_own_method_stands_beside_the_fit(tmp_path: Path) -> None:
    coast = {"duration_s": 0.5, "mode": "coast"}
    runs = [
        {"name": f"step{power}", "segments": [{"duration_s": 1.3, "power_pct": power}, coast]}
        for power in (30, 60, -80, 100)
    ]
    found = identify(small("motor_identification", runs=runs), tmp_path, motor_bench())
    by_paper = found.value("paper_coulomb_friction_nm")
    assert by_paper.value == pytest.approx(0.012 * 7.6 / 7.1, rel=0.5)
    assert found.value("coasting_coulomb_over_inertia").value == pytest.approx(0.012 / 1.35e-3, rel=0.1)


def test_a_motor_that_is_not_the_models_is_warned_of_and_its_folder_is_a_case(tmp_path: Path) -> None:
    coast = {"duration_s": 0.8, "mode": "coast"}
    runs = [
        {"name": f"step{power}", "segments": [{"duration_s": 1.0, "power_pct": power}, coast]}
        for power in (100, -60, 30, -20)
    ]
    experiment = small("motor_identification", runs=runs)
    sticky = motor_bench(stiction={"breakaway_torque_nm": 0.03, "stribeck_speed_rad_s": 2.0})
    found = identify(experiment, tmp_path / "sticky", sticky)
    assert "physics is missing" in found.notes[0]
    found.write(tmp_path / "sticky" / "run")
    case = read_case(tmp_path / "sticky" / "run")
    assert [recording.rows > 100 for recording in case.recordings] == [True] * len(runs)
    plain = identify(experiment, tmp_path / "plain", motor_bench())
    assert not any("physics is missing" in note for note in plain.notes)


def test_the_plant_that_is_written_can_be_read_and_is_what_was_found(tmp_path: Path) -> None:
    found = identify(small("motor_identification"), tmp_path, motor_bench())
    paths = found.write(tmp_path)
    assert [path.name for path in paths] == ["identified.json", "plant.yaml", "case.yaml"]
    config = yaml.safe_load(paths[1].read_text())
    plant_from_config(config, "power_pct")
    assert config["inertia_kg_m2"] == pytest.approx(found.value("inertia_kg_m2").value, rel=1e-5)
    assert "effects" not in config
    document = json.loads(paths[0].read_text())
    assert document["schema"] == "nxt-twin/identified/1"
    value = document["values"][0]
    assert value["interval_95"][0] < value["value"] < value["interval_95"][1]


def test_a_distance_sweep_finds_the_papers_sensor(tmp_path: Path) -> None:
    found = identify(small("distance_sweep"), tmp_path)
    echo = Echo()
    assert near(found, "scale", echo.stretch)
    assert near(found, "near_offset_mm", echo.early_shift)
    assert near(found, "near_below_mm", echo.early_below)
    assert near(found, "noise_per_distance", echo.jitter_per_mm)
    assert found.value("blind_distance_mm").covers(echo.deaf_below)
    path = found.write(tmp_path)[1]
    assert path.name == "sensor.yaml"
    assert UltrasonicParameters.from_config(yaml.safe_load(path.read_text())).scale == pytest.approx(
        found.value("scale").value
    )


def test_an_angle_sweep_finds_the_beam(tmp_path: Path) -> None:
    experiment = small("angle_sweep", distance_mm={"first": 238, "last": 1438, "step": 200}, samples=8)
    found = identify(experiment, tmp_path)
    assert near(found, "max_angle_deg", 55.0)
    assert near(found, "far_angle_deg", 15.0)
    assert near(found, "contact_angle_deg", 30.0)


def test_a_gradient_sweep_keeps_one_slope_under_two_lights(tmp_path: Path) -> None:
    found = identify(small("gradient_sweep"), tmp_path)
    assert near(found, "slope_raw_per_mm", -1.1)
    assert near(found, "zero_raw[dark]", 620.0)
    assert near(found, "noise_raw", 2.0)
    assert "agree on one slope" in found.notes[0]


@pytest.mark.parametrize(("axis", "unit"), [("force_g", 1.0), ("compression_mm", 0.04)])
def test_touch_cycles_find_both_thresholds(axis: str, unit: float, tmp_path: Path) -> None:
    push = {"first": 45 * unit, "last": 62 * unit, "step": unit}
    found = identify(small("touch_cycles", axis=axis, push=push, cycles=4), tmp_path)
    names = (
        ("press_force_g", "release_force_g")
        if axis == "force_g"
        else ("press_travel_mm", "release_travel_mm")
    )
    truths = (57.0, 53.0) if axis == "force_g" else (2.11, 1.80)
    for name, truth in zip(names, truths, strict=True):
        assert near(found, name, truth, 3.0)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_two_sensors_tell_the_receiver_from_the_emitter(side: float, tmp_path: Path) -> None:
    experiment = small("two_sensors")
    bench = workbench(seed=2)
    place_transducers(bench.body, (3, 0), bench.rig, Transducers(side * 15.0, -side * 16.0), Random(3))
    found = identify(experiment, tmp_path, bench)
    assert near(found, "receiver_mm", side * 15.0)
    assert near(found, "emitter_mm", -side * 16.0)
    assert ("right" if side > 0 else "left") in found.notes[0]


def test_a_strip_that_covers_nothing_is_noticed(tmp_path: Path) -> None:
    bench = workbench(seed=2)
    place_transducers(bench.body, (3, 0), bench.rig, Transducers(strip=2.0), Random(3))
    with pytest.raises(ExperimentError, match="never kept an echo away"):
        identify(small("two_sensors"), tmp_path, bench)


def test_a_sensor_that_hears_nothing_is_noticed(tmp_path: Path) -> None:
    experiment = small("distance_sweep")
    bench = workbench()
    place_ultrasonic(bench.body, 3, bench.rig, Echo(deaf_below=5000.0), Random(1))
    with pytest.raises(ExperimentError, match="no reading has an echo"):
        identify(experiment, tmp_path, bench)


def test_a_button_that_is_never_pressed_is_noticed(tmp_path: Path) -> None:
    with pytest.raises(ExperimentError, match="never both"):
        identify(small("touch_cycles", push={"first": 5, "last": 20, "step": 1}), tmp_path)


def test_combining_is_the_weighted_mean_where_that_is_right() -> None:
    x, spread, left = combined(
        np.array([1.0, 3.0]), np.diag([1.0, 4.0]), lambda x: np.array([x[0], x[0]]), np.array([2.0])
    )
    assert x[0] == pytest.approx(1.4)
    assert spread[0, 0] == pytest.approx(0.8)
    assert left == pytest.approx(4.0 / 5.0)


def test_doubt_is_propagated_to_a_ratio() -> None:
    value, spread = propagated(lambda x: x[:1] / x[1:], np.array([2.0, 4.0]), np.diag([0.04, 0.16]))
    assert value[0] == 0.5
    assert spread[0, 0] == pytest.approx((0.1**2 + 0.1**2) * 0.25)


def test_weighing_gives_quantiles() -> None:
    tried = np.linspace(-6.0, 6.0, 2001)
    value = weighed("x", tried, -0.5 * tried**2, "")
    assert (value.value, value.std) == (pytest.approx(0.0, abs=1e-9), pytest.approx(1.0, rel=1e-3))
    assert (value.low, value.high) == (pytest.approx(-1.96, abs=0.01), pytest.approx(1.96, abs=0.01))
    flat = weighed("x", np.linspace(0.0, 1.0, 1001), np.zeros(1001), "")
    assert (flat.low, flat.high) == (pytest.approx(0.025, abs=2e-3), pytest.approx(0.975, abs=2e-3))


def test_an_interval_covers_what_is_in_it() -> None:
    value = normal_value("x", 1.0, 0.5, "m")
    assert value.covers(1.9)
    assert not value.covers(2.1)
