from pathlib import Path

import numpy as np
import pytest
from experiment_bench import Impatient, bench_for, new_folder, rows_of, small, surroundings

from nxt_twin.brick.errors import LinkLostError
from nxt_twin.experiment.errors import ExperimentError, PositionerError, StoppedError
from nxt_twin.experiment.folder import RunFolder
from nxt_twin.experiment.identify import carry_out
from nxt_twin.experiment.plan import Experiment, MotorIdentification
from nxt_twin.experiment.positioner.positioner import Limits
from nxt_twin.experiment.run_sweep import Apparatus, SweepProgress
from nxt_twin.experiment.standin.rig import RigMover
from nxt_twin.recording.files import read_recording


class Faltering:
    """A positioner that is interrupted at one of its moves."""

    def __init__(self, inner: RigMover, at_move: int, error: BaseException) -> None:
        self._inner = inner
        self._left = at_move
        self._error = error
        self.stopped = 0

    @property
    def axis(self) -> str:
        return self._inner.axis

    @property
    def limits(self) -> Limits:
        return self._inner.limits

    def move_to(self, value: float) -> float:
        self._left -= 1
        if self._left == 0:
            raise self._error
        return self._inner.move_to(value)

    def stop(self) -> None:
        self.stopped += 1

    def close(self) -> None:
        self.stop()


TOUCH = ("time_s", "s1_touch", "rig_force_g")
DISTANCE = ("time_s", "s4_ultrasonic_cm", "rig_distance_mm")


def faltering(around: Apparatus, at_move: int, error: BaseException) -> tuple[Apparatus, Faltering]:
    last = list(around.positioners)[-1]
    positioner = Faltering(around.positioners[last], at_move, error)  # type: ignore[arg-type]
    movers = {**around.positioners, last: positioner}
    return Apparatus(around.brick, around.clock, movers, around.ask, around.tell), positioner  # type: ignore[arg-type]


def run(experiment: Experiment, path: Path, seed: int = 1) -> RunFolder:
    folder = new_folder(path, experiment)
    carry_out(experiment, folder, surroundings(bench_for(experiment, seed), experiment))
    return folder


def test_a_sweep_is_a_recording(tmp_path: Path) -> None:
    experiment = small("distance_sweep")
    folder = run(experiment, tmp_path)
    recording = read_recording(folder.path / "recordings" / "sweep.csv")
    assert set(recording.columns) == {"time_s", "s4_ultrasonic_cm", "rig_distance_mm"}
    assert recording.rows == 49 * 2
    far = recording.columns["rig_distance_mm"] > 300
    off = recording.columns["s4_ultrasonic_cm"] - recording.columns["rig_distance_mm"] / 10
    assert abs(off[far]).max() < 5


@pytest.mark.slow_variants
@pytest.mark.parametrize("kind", ["distance_sweep", "angle_sweep", "gradient_sweep", "two_sensors"])
def test_an_interrupted_sweep_goes_on_where_it_stopped(kind: str, tmp_path: Path) -> None:
    experiment = small(kind)
    whole = run(experiment, tmp_path / "whole")
    folder = new_folder(tmp_path / "pieces", experiment)
    bench = bench_for(experiment)
    moves: list[int] = []
    for at_move, error in ((4, KeyboardInterrupt()), (9, LinkLostError("gone")), (3, StoppedError("enough"))):
        broken, positioner = faltering(surroundings(bench, experiment), at_move, error)
        with pytest.raises(type(error)):
            carry_out(experiment, folder, broken)
        assert positioner.stopped
        moves.append(at_move)
    told: list[SweepProgress] = []
    carry_out(experiment, RunFolder(folder.path, experiment), surroundings(bench, experiment, told))
    assert told[0].done >= sum(moves) - len(moves) - 3
    for path in sorted((whole.path / "recordings").iterdir()):
        lines, others = (rows_of(f.path, path.stem) for f in (folder, whole))
        if kind != "angle_sweep":  # whose number of places is up to chance
            assert len(lines) == len(others)
        pieces = read_recording(folder.path / "recordings" / path.name)
        assert list(pieces.columns["time_s"]) == sorted(pieces.columns["time_s"])
        rig = [name for name in pieces.columns if name.startswith("rig_")]
        first = read_recording(path)
        count = min(pieces.rows, first.rows)
        for name in rig:
            assert list(pieces.columns[name][:count]) == list(first.columns[name][:count])


def test_a_press_cycle_that_was_cut_off_is_done_again(tmp_path: Path) -> None:
    experiment = small("touch_cycles")
    folder = new_folder(tmp_path, experiment)
    bench = bench_for(experiment)
    broken, _ = faltering(surroundings(bench, experiment), 60, KeyboardInterrupt())
    with pytest.raises(KeyboardInterrupt):
        carry_out(experiment, folder, broken)
    assert folder.finished("cycle-001")
    assert len(folder.begun("cycle-002", TOUCH)) == 59 - 41
    carry_out(experiment, folder, surroundings(bench, experiment))
    assert len(rows_of(folder.path, "cycle-002")) == 1 + 41
    assert folder.begun("cycle-002", TOUCH) == []


@pytest.mark.parametrize(
    "damage", [b"\x8e\xff\x00", b"0.5,30\n", b"0.5,thirty,300\n", b"0.5,30,300,7\n", b"0.5,nan,300\n"]
)
def test_a_damaged_part_is_refused_by_name(tmp_path: Path, damage: bytes) -> None:
    experiment = small("distance_sweep")
    folder = new_folder(tmp_path, experiment)
    broken, _ = faltering(surroundings(bench_for(experiment), experiment), 5, KeyboardInterrupt())
    with pytest.raises(KeyboardInterrupt):
        carry_out(experiment, folder, broken)
    part = folder.path / "recordings" / "sweep.csv.part"
    part.write_bytes(part.read_bytes() + damage)
    with pytest.raises(ExperimentError, match="damaged"):
        carry_out(experiment, folder, surroundings(bench_for(experiment), experiment))


def test_a_line_that_a_crash_cut_off_is_left_out(tmp_path: Path) -> None:
    experiment = small("distance_sweep")
    folder = new_folder(tmp_path, experiment)
    broken, _ = faltering(surroundings(bench_for(experiment), experiment), 5, KeyboardInterrupt())
    with pytest.raises(KeyboardInterrupt):
        carry_out(experiment, folder, broken)
    part = folder.path / "recordings" / "sweep.csv.part"
    text = part.read_text()
    part.write_text(text[: text.rindex(",")])
    assert len(folder.begun("sweep", DISTANCE)) == 7
    carry_out(experiment, folder, surroundings(bench_for(experiment), experiment))
    assert len(rows_of(folder.path, "sweep")) == 1 + 98


def test_a_finished_run_is_not_run_again(tmp_path: Path) -> None:
    experiment = small("touch_cycles")
    folder = run(experiment, tmp_path)
    before = rows_of(folder.path, "cycle-001")
    broken, _ = faltering(surroundings(bench_for(experiment), experiment), 1, AssertionError("moved"))
    carry_out(experiment, folder, broken)
    assert rows_of(folder.path, "cycle-001") == before


def test_a_folder_of_another_experiment_is_refused(tmp_path: Path) -> None:
    folder = new_folder(tmp_path, small("touch_cycles"))
    with pytest.raises(ExperimentError, match="another experiment"):
        RunFolder(folder.path, small("touch_cycles", cycles=4))
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "thesis.txt").write_text("do not touch")
    with pytest.raises(ExperimentError, match="not empty"):
        RunFolder(tmp_path / "other", small("touch_cycles"))


def test_nothing_moves_if_one_place_is_out_of_the_limits(tmp_path: Path) -> None:
    experiment = small("distance_sweep")
    bench = bench_for(experiment)
    around = surroundings(bench, experiment)
    short = RigMover(bench.rig, "distance_mm", Limits(0.0, 1000.0))
    with pytest.raises(PositionerError, match="outside"):
        carry_out(
            experiment,
            new_folder(tmp_path, experiment),
            Apparatus(around.brick, around.clock, {"distance_mm": short}, around.ask),
        )
    assert bench.rig.value("distance_mm") == 0.0


def test_an_axis_that_nothing_moves_is_named(tmp_path: Path) -> None:
    experiment = small("distance_sweep")
    around = surroundings(bench_for(experiment), experiment)
    with pytest.raises(ExperimentError, match="distance_mm"):
        carry_out(
            experiment,
            new_folder(tmp_path, experiment),
            Apparatus(around.brick, around.clock, {}, around.ask),
        )


def test_the_beam_is_followed_until_nothing_is_heard(tmp_path: Path) -> None:
    folder = run(small("angle_sweep"), tmp_path)
    recording = read_recording(folder.path / "recordings" / "distance-0338.csv")
    angle, reading = recording.columns["rig_angle_deg"], recording.columns["s4_ultrasonic_cm"]
    assert angle.max() < 90
    assert (reading[angle == angle.max()] == 255).all()
    assert (reading[angle == angle.max() - 5] < 255).any()


def test_each_room_light_is_asked_for(tmp_path: Path) -> None:
    experiment = small("gradient_sweep")
    bench = bench_for(experiment)
    asked: list[str] = []

    def ask(request: str) -> str:
        asked.append(request)
        return ""

    around = surroundings(bench, experiment)
    carry_out(
        experiment,
        new_folder(tmp_path, experiment),
        Apparatus(around.brick, around.clock, around.positioners, ask),
    )
    assert ["'dark'" in asked[0], "'lamp'" in asked[1], len(asked)] == [True, True, 2]


def test_motor_runs_are_recorded_as_commanded(tmp_path: Path) -> None:
    experiment = small("motor_identification")
    folder = run(experiment, tmp_path)
    columns = read_recording(folder.path / "recordings" / "bare-step-80.csv").columns
    assert set(columns) == {"time_s", "a_power_pct", "a_mode", "a_tacho_deg", "battery_v"}
    assert list(dict.fromkeys(columns["a_power_pct"])) == [0, -80]
    assert columns["a_tacho_deg"][-1] < columns["a_tacho_deg"][0] - 500
    assert columns["battery_v"][0] > 7


def test_a_run_waits_until_the_motor_has_come_to_rest(tmp_path: Path) -> None:
    folder = run(small("motor_identification"), tmp_path)
    for name in ("bare-step60", "bare-step-80"):
        columns = read_recording(folder.path / "recordings" / f"{name}.csv").columns
        standing = columns["a_power_pct"] == 0
        before = columns["a_tacho_deg"][: int(np.argmin(standing))]
        assert before.size > 3
        assert np.ptp(before) == 0


def test_a_motor_run_that_is_interrupted_leaves_the_motor_coasting_and_is_done_again(tmp_path: Path) -> None:
    experiment = small("motor_identification")
    folder = new_folder(tmp_path, experiment)
    bench = bench_for(experiment)
    around = surroundings(bench, experiment)
    with pytest.raises(KeyboardInterrupt):
        carry_out(experiment, folder, Apparatus(around.brick, Impatient(bench.clock, 2.8), {}, around.ask))
    assert bench.brick.motors.read(0).value.mode == 0
    assert folder.finished("bare-step100")
    assert (folder.path / "recordings" / "bare-step60.csv.part").exists()
    carry_out(experiment, folder, around)
    assert folder.finished("bare-step60")
    assert folder.finished("bare-step-80")


def test_a_motor_that_turns_too_far_is_stopped(tmp_path: Path) -> None:
    experiment = small("motor_identification", most_turn_deg=90.0)
    bench = bench_for(experiment)
    with pytest.raises(ExperimentError, match="turned"):
        carry_out(experiment, new_folder(tmp_path, experiment), surroundings(bench, experiment))
    assert bench.brick.motors.read(0).value.mode == 0


def test_names_of_runs_are_safe_for_files() -> None:
    with pytest.raises(ValueError, match="name"):
        MotorIdentification.model_validate(
            {
                "kind": "motor_identification",
                "name": "x",
                "runs": [{"name": "../a", "segments": [{"duration_s": 1}]}] * 2,
            }
        )
