from pathlib import Path

import pytest
from experiment_bench import small

from nxt_twin.errors import ProgramError
from nxt_twin.experiment.errors import ExperimentError, PositionerError
from nxt_twin.experiment.outline import axes_of, outline
from nxt_twin.experiment.plan import Range, dump_experiment, read_experiment
from nxt_twin.experiment.positioner.nx100 import RobotSetUp
from nxt_twin.experiment.positioner.open import assigned
from nxt_twin.experiment.positioner.rail import RailSetUp
from nxt_twin.experiment.positioner.spec import PositionerSpec, read_spec
from nxt_twin.experiment.sweep import sweep_of
from nxt_twin.recording.configs import configs_dir

EXPERIMENTS = sorted(path.stem for path in (configs_dir() / "experiments").glob("*.yaml"))


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_experiment_files_can_be_read_and_written_back(name: str, tmp_path: Path) -> None:
    experiment = read_experiment(name)
    copy = tmp_path / "copy.yaml"
    copy.write_text(dump_experiment(experiment), encoding="utf-8")
    assert read_experiment(copy) == experiment


def test_the_papers_numbers() -> None:
    distance = sweep_of(read_experiment("distance_sweep"))  # type: ignore[arg-type]
    assert [place for (place,) in distance.parts[0].places] == list(range(10, 1551))
    angle = sweep_of(read_experiment("angle_sweep"))  # type: ignore[arg-type]
    assert [part.places[0][0] for part in angle.parts] == list(range(138, 1539, 100))
    assert [place[1] for place in angle.parts[0].places[:3]] == [0, 5, 10]
    assert angle.samples == 64
    touch = sweep_of(read_experiment("touch_force"))  # type: ignore[arg-type]
    assert len(touch.parts) == 8
    assert len({part.name for part in angle.parts}) == 15


def test_a_range_includes_both_ends_and_may_fall() -> None:
    assert Range(first=0.0, last=0.3, step=0.1).values() == (0.0, 0.1, 0.2, 0.3)
    assert Range(first=2, last=0, step=1).values() == (2, 1, 0)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("kind: distance_swep\nname: x\n", "no kind of experiment"),
        ("name: x\n", "has no kind"),
        ("kind: distance_sweep\nname: x\ndistance: 3\n", "distance_mm"),
        ("kind: distance_sweep\nname: x\ndistance_mm: {first: 0, last: 1e9, step: 1}\n", "more than"),
        ("kind: touch_cycles\nname: x\npush: {first: 9, last: 1, step: 1}\n", "pressed"),
        ("kind: two_sensors\nname: x\nslot: 1\nposition_mm: {first: 0, last: 9, step: 1}\n", "two ports"),
    ],
)
def test_what_is_no_experiment_is_refused_with_its_key(text: str, says: str, tmp_path: Path) -> None:
    path = tmp_path / "wrong.yaml"
    path.write_text(text)
    with pytest.raises(ProgramError, match=says):
        read_experiment(path)


def test_an_unknown_name_is_refused_with_the_nearest() -> None:
    with pytest.raises(ProgramError, match="distance_sweep"):
        read_experiment("distance_sweeps")


def test_positioners_are_read_with_their_keys() -> None:
    assert read_spec("hand") == PositionerSpec("hand")
    rail = read_spec("distance_mm=rail:b,mm_per_deg=-0.3,play_deg=4,homing=touch,touch_slot=2")
    assert rail.axis == "distance_mm"
    assert rail.set_up == RailSetUp(-0.3, play_deg=4.0, homing="touch", touch_slot=2)
    robot = read_spec("nx100:10.0.0.2:8080,along=rx,value_now=5,sign=-1")
    assert (robot.address, robot.port) == ("10.0.0.2", 8080)
    assert robot.set_up == RobotSetUp("rx", -1, 5.0)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "foot",
        "rail:b",
        "rail:d,mm_per_deg=1",
        "rail:b,mm_per_deg=x",
        "nx100:",
        "nx100:h,along=w",
        "nx100:h,up=1",
        "nx100:h:0",
        "nx100:h:65536",
        "nx100:h:" + "9" * 5000,
        "nx100:h,along=x,value_now=nan",
        "rail:b,mm_per_deg=inf",
        "rail:b,mm_per_deg=1,touch_slot=" + "9" * 400,
    ],
)
def test_what_is_no_positioner_is_refused(text: str) -> None:
    with pytest.raises(ProgramError):
        read_spec(text)


def test_a_hand_moves_what_no_other_does() -> None:
    specs = assigned([read_spec("angle_deg=nx100:h,along=rx")], ("distance_mm", "angle_deg"))
    assert [specs[axis].kind for axis in ("distance_mm", "angle_deg")] == ["hand", "nx100"]
    with pytest.raises(ExperimentError, match="not moved"):
        assigned([read_spec("force_g=hand")], ("distance_mm",))
    with pytest.raises(ExperimentError, match="two positioners"):
        assigned([read_spec("distance_mm=hand"), read_spec("distance_mm=hand")], ("distance_mm",))
    with pytest.raises(ExperimentError, match="nothing is left"):
        assigned([read_spec("hand")], ())


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_the_outline_says_what_will_be_done(name: str) -> None:
    experiment = read_experiment(name)
    lines = list(outline(experiment, assigned([], axes_of(experiment))))
    assert lines[0].startswith(experiment.name)
    assert "takes" in lines[-1]


def test_the_outline_refuses_what_nothing_may_do() -> None:
    too_far = small("touch_cycles", axis="compression_mm", push={"first": 0, "last": 40, "step": 1})
    with pytest.raises(PositionerError, match="outside"):
        list(outline(too_far, assigned([], axes_of(too_far))))
