import json
from pathlib import Path

import pytest
from experiment_bench import small
from typer.testing import CliRunner

from nxt_twin.brick.errors import LinkRefusedError
from nxt_twin.cli.app import program
from nxt_twin.experiment.errors import ExperimentError
from nxt_twin.experiment.plan import dump_experiment

RUNNER = CliRunner()


def run(*arguments: str) -> str:
    result = RUNNER.invoke(program(["identify"]), ["identify", *arguments])
    if result.exception and not isinstance(result.exception, SystemExit):
        raise result.exception
    assert result.exit_code == 0, result.output
    return result.stdout


def write(kind: str, folder: Path, **changes: object) -> str:
    path = folder / f"{kind}.yaml"
    path.write_text(dump_experiment(small(kind, **changes)), encoding="utf-8")
    return str(path)


def test_a_dry_run_touches_nothing(tmp_path: Path) -> None:
    out = tmp_path / "run"
    text = run(
        "angle_sweep",
        "usb:",
        "--dry-run",
        "--out",
        str(out),
        "--positioner",
        "distance_mm=rail:b,mm_per_deg=1",
    )
    assert "moved by rail:b,mm_per_deg=1" in text
    assert "angle_deg: 0 to 90 deg, moved by hand" in text
    assert not out.exists()


def test_on_the_mock_from_beginning_to_end(tmp_path: Path) -> None:
    file, out = write("touch_cycles", tmp_path), tmp_path / "run"
    text = run(file, "mock:?seed=3", "--out", str(out))
    assert "press_force_g" in text
    names = {path.name for path in out.iterdir()}
    assert names == {"experiment.yaml", "recordings", "identified.json", "sensor.yaml", "case.yaml"}
    again = json.loads(run(file, "mock:?seed=99", "--out", str(out), "--json", "-"))
    assert again == json.loads((out / "identified.json").read_text())


@pytest.mark.parametrize(
    "mover", ["rail:b,mm_per_deg=0.3,play_deg=6,power_pct=60", "nx100:robot,along=z,value_now=0"]
)
def test_a_rail_and_a_robot_move_the_mocks_target(mover: str, tmp_path: Path) -> None:
    far = {"first": 260, "last": 1460, "step": 150}
    file = write("distance_sweep", tmp_path, distance_mm=far, samples=4)
    run(file, "mock:?seed=3", "--out", str(tmp_path / "run"), "--positioner", mover)
    found = json.loads((tmp_path / "run" / "identified.json").read_text())
    scale = next(value for value in found["values"] if value["name"] == "scale")
    assert scale["value"] == pytest.approx(1.0055, abs=4 * scale["std"])


def test_another_experiment_in_the_folder_is_refused(tmp_path: Path) -> None:
    out = tmp_path / "run"
    run(write("touch_cycles", tmp_path), "mock:", "--out", str(out))
    with pytest.raises(ExperimentError, match="another experiment"):
        run(write("gradient_sweep", tmp_path), "mock:", "--out", str(out))


def test_without_a_folder_it_is_wrong_use() -> None:
    assert RUNNER.invoke(program(["identify"]), ["identify", "touch_force", "mock:"]).exit_code == 2


@pytest.mark.parametrize(
    "wrong",
    [
        ["touch_force", "nowhere:1"],
        ["touch_force", "mock:seed=x"],
        ["touch_force", "mock:", "--positioner", "bogus"],
        ["touch_force", "mock:", "--positioner", "angle_deg=hand"],
        ["motor_steps", "mock:", "--positioner", "hand"],
    ],
)
def test_a_url_or_positioner_that_cannot_be_is_wrong_use(tmp_path: Path, wrong: list[str]) -> None:
    result = RUNNER.invoke(program(["identify"]), ["identify", *wrong, "--out", str(tmp_path / "run")])
    assert result.exit_code == 2


@pytest.mark.parametrize(
    "wrong",
    [
        ["motor_steps", "mock:?profile=telegraph"],
        ["motor_steps_disc", "mock:?conceal=7"],
        ["motor_steps", "usb:"],
        ["distance_sweep", "usb:", "--positioner", "rail:b,mm_per_deg=0.3"],
    ],
)
def test_nothing_is_left_by_what_is_not_begun(tmp_path: Path, wrong: list[str]) -> None:
    """Among it motors of a real brick, of which nobody is there to be asked."""
    result = RUNNER.invoke(program(["identify"]), ["identify", *wrong, "--out", str(tmp_path / "run")])
    assert result.exit_code == 2
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("wanted", [["motor_steps", "--yes"], ["touch_force"]])
def test_a_brick_is_looked_for_where_nobody_has_to_be_asked(tmp_path: Path, wanted: list[str]) -> None:
    with pytest.raises(LinkRefusedError):
        run(*wanted, "usb:00165300DEAD", "--out", str(tmp_path / "run"))


def test_names_are_listed() -> None:
    told = json.loads(run("--json", "-"))
    names = [each["name"] for each in told["experiments"]]
    assert [line.split()[0] for line in run().splitlines()] == names
    assert {"motor_steps", "two_sensors"} < set(names)


@pytest.mark.slow_variants
@pytest.mark.parametrize("kind", ["distance_sweep", "angle_sweep", "touch_cycles", "gradient_sweep"])
def test_nothing_is_missing_from_a_sensor_that_was_identified(tmp_path: Path, kind: str) -> None:
    run(write(kind, tmp_path), "mock:?seed=3", "--out", str(tmp_path / "run"))
    result = RUNNER.invoke(program(["diagnose"]), ["diagnose", str(tmp_path / "run"), "--json", "-"])
    assert result.exit_code == 0, result.output
    assert json.loads(result.stdout)["verdict"] == "adequate"


@pytest.mark.slow
def test_what_the_mock_conceals_is_in_the_motor_that_is_tried(tmp_path: Path) -> None:
    (tmp_path / "secret.yaml").write_text("effects: [spring_load]\nsize: large\nseed: 3\n", encoding="utf-8")
    (tmp_path / "world.yaml").write_text("battery: {internal_resistance_ohm: 0.0}\n", encoding="utf-8")
    mock = f"mock:?seed=3&world={tmp_path}/world.yaml"
    assert "physics is missing" not in run("motor_steps", mock, "--out", str(tmp_path / "plain"))
    concealing = f"{mock}&conceal={tmp_path}/secret.yaml"
    assert "physics is missing" in run("motor_steps", concealing, "--out", str(tmp_path / "held"))
