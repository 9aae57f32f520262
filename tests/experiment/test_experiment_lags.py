"""Runs of a motor over several links, and a diagnosis of the folders that they leave, both by the program itself."""

import json
from pathlib import Path

import pytest
from experiment_bench import Impatient, bench_for, new_folder, small, surroundings
from typer.testing import CliRunner

from nxt_twin.cli.app import program
from nxt_twin.experiment.identify import carry_out
from nxt_twin.experiment.run_sweep import Apparatus
from nxt_twin.recording.files import read_recording

RUNS = ["step-100", "step-60", "step-back-80", "step-32", "step-back-40", "step-80"]
PLAIN = "battery: {internal_resistance_ohm: 0.0}\n"
STICKY = """
motors:
  a:
    {kind: dc_motor, resistance_ohm: 7.6, inductance_h: 4.88e-3, torque_constant_nm_per_a: 0.4908,
     back_emf_v_s_per_rad: 0.4908, coulomb_friction_nm: 8.45e-3, viscous_friction_nm_s_per_rad: 1.92e-3,
     inertia_kg_m2: 1.2e-3, effects: {stiction: {breakaway_torque_nm: 0.025, stribeck_speed_rad_s: 2.0}}}
"""


def told(*arguments: str) -> str:
    result = CliRunner().invoke(program(arguments[:1]), arguments)
    if result.exception and not isinstance(result.exception, SystemExit):
        raise result.exception
    assert result.exit_code == 0, result.output
    return result.stdout


def identified(folder: Path, world: str, profile: str) -> Path:
    file, out = folder / "world.yaml", folder / "run"
    file.write_text(world, encoding="utf-8")
    told("identify", "motor_steps", f"mock:?world={file}&profile={profile}&seed=5", "--out", str(out))
    return out


def named(out: Path) -> list[str]:
    found = json.loads(told("diagnose", str(out), "--json", "-"))
    assert found["verdict"] == ("explained" if found["effects"] else "adequate")
    return [effect["id"] for effect in found["effects"]]


@pytest.mark.parametrize("profile", ["none", pytest.param("bluetooth", marks=pytest.mark.slow)])
def test_nothing_is_missing_from_a_motor_that_is_the_models(tmp_path: Path, profile: str) -> None:
    out = identified(tmp_path, PLAIN, profile)
    assert sorted(path.stem for path in (out / "recordings").glob("*.yaml")) == sorted(
        f"bare-{run}" for run in RUNS
    )
    assert named(out) == []
    for sidecar in (out / "recordings").glob("*.yaml"):
        sidecar.unlink()
    expected = [] if profile == "none" else ["command_delay"]  # two milliseconds are too little for a name
    assert named(out) == expected


@pytest.mark.slow
def test_what_is_in_the_mock_is_all_that_is_named(tmp_path: Path) -> None:
    """Its battery has a resistance that is so small that it need not show."""
    assert named(identified(tmp_path, STICKY, "usb")) in (["stiction"], ["stiction", "battery_sag"])


@pytest.mark.parametrize(("profile", "least_s", "most_s"), [("none", 1e-3, 2e-3), ("bluetooth", 0.015, 0.05)])
def test_every_recording_tells_the_lags_of_its_own_run(
    tmp_path: Path, profile: str, least_s: float, most_s: float
) -> None:
    experiment = small("motor_identification")
    folder = new_folder(tmp_path, experiment)
    carry_out(experiment, folder, surroundings(bench_for(experiment, profile=profile), experiment))
    lags = [read_recording(path).lags for path in (folder.path / "recordings").glob("*.csv")]
    assert len(lags) == 3
    for each in lags:
        assert least_s < each.read_before_s("a")[0] < most_s
        assert 0.0 < each.acted_after_s("a")[0] < most_s
    if profile == "bluetooth":
        assert len({each.acted_after_s("a")[0] for each in lags}) == 3


def test_a_run_that_is_done_again_tells_its_lags_when_it_is_done(tmp_path: Path) -> None:
    experiment = small("motor_identification")
    folder = new_folder(tmp_path, experiment)
    bench = bench_for(experiment)
    around = surroundings(bench, experiment)

    def beside(suffix: str) -> set[str]:
        return {path.stem for path in (folder.path / "recordings").glob(f"*{suffix}")}

    with pytest.raises(KeyboardInterrupt):
        carry_out(experiment, folder, Apparatus(around.brick, Impatient(bench.clock, 2.8), {}, around.ask))
    assert beside(".yaml") == beside(".csv") == {"bare-step100"}
    carry_out(experiment, folder, around)
    assert beside(".yaml") == beside(".csv") == {"bare-step100", "bare-step60", "bare-step-80"}
