"""Carry motor runs out: command, poll, write down; always end coasting."""

from __future__ import annotations

from collections import deque
from typing import Final, final

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.errors import BrickError
from nxt_twin.experiment.errors import ExperimentError
from nxt_twin.experiment.folder import RowWriter, RunFolder
from nxt_twin.experiment.plan import Load, MotorIdentification
from nxt_twin.experiment.run_sweep import Apparatus, SweepProgress
from nxt_twin.recording.columns import BATTERY, TIME, mode_column, power_column, tacho_column
from nxt_twin.recording.program import MotorCommand, Run, commands
from nxt_twin.twin.dating import Dating
from nxt_twin.twin.polling import OUTPUTS, tell

_BATTERY_READINGS: Final = 5
"""Of the resting battery before each run: the motor's own current would pull later ones down."""

_MOST_RESTS: Final = 5
"""So often a motor that still turns after a rest gets another one."""


def recording_name(load: Load, run: Run) -> str:
    """The name of the recording of a run under a load."""
    return f"{load.name}-{run.name}"


def run_motor(experiment: MotorIdentification, folder: RunFolder, around: Apparatus) -> None:
    """Do every run that the folder does not hold yet; one that was cut off is done again.

    Raises:
        ExperimentError: a motor turned further than it may.
        BrickError: the brick does not answer.
    """
    total = len(experiment.loads) * len(experiment.runs)
    done = 0
    for load in experiment.loads:
        missing = [run for run in experiment.runs if not folder.finished(recording_name(load, run))]
        if missing and len(experiment.loads) > 1:
            around.ask(f"{_request(load)} [Enter when done] ")
        for run in experiment.runs:
            if run in missing:
                around.tell(SweepProgress(done, total, recording_name(load, run)))
                _record(experiment, load, run, folder, around)
            done += 1


def _request(load: Load) -> str:
    if load.added_inertia_kg_m2 == 0.0:
        return f"Please take everything off the motor's hub ({load.name})."
    return f"Please put the disc of {load.added_inertia_kg_m2:.6g} kg·m² on the motor's hub ({load.name})."


def _record(
    experiment: MotorIdentification, load: Load, run: Run, folder: RunFolder, around: Apparatus
) -> None:
    port = experiment.port
    columns = (TIME, power_column(port), mode_column(port), tacho_column(port), BATTERY)
    with folder.write(recording_name(load, run), columns) as writer:
        recorder = _Recorder(experiment, run, writer, around)
        try:
            recorder.rest()
            recorder.drive()
        finally:
            _let_go(around.brick)
        recorder.row_lags.write_beside(writer.path)
        writer.finish()


def _let_go(brick: Brick) -> None:
    try:
        brick.motors.coast()
    except BrickError:
        return  # the link is lost, which the run's own error tells


@final
class _Recorder:
    """One run.

    Attributes:
        row_lags: by how much what is in a row is off its stamp.
    """

    def __init__(
        self, experiment: MotorIdentification, run: Run, writer: RowWriter, around: Apparatus
    ) -> None:
        self._experiment = experiment
        self._output = OUTPUTS[experiment.port]
        self._writer = writer
        self._brick = around.brick
        self._clock = around.clock
        self._waiting = deque(commands(run))
        self._duration_s = run.duration_s
        self._in_force = MotorCommand(0.0, 0, "coast")
        self._zero_s = self._clock.now_s()
        self._start_deg: int | None = None
        self._dating = Dating(around.pace)
        self.row_lags = self._dating.row_lags

    def rest(self) -> None:
        """Let the motor come to rest, whatever it was doing, and read the battery then.

        One that something keeps turning is recorded as it is.
        """
        self._brick.device.keep_awake()
        self._brick.motors.coast(self._output)
        for _ in range(_MOST_RESTS):
            before_deg = self._brick.motors.tacho_deg(self._output).value
            self._clock.sleep(self._experiment.rest_s)
            if self._brick.motors.tacho_deg(self._output).value == before_deg:
                break
        self._zero_s = self._clock.now_s()
        for _ in range(_BATTERY_READINGS):
            self._row(battery_v=self._brick.device.battery_v().value)
            self._clock.sleep(self._experiment.poll_s)

    def drive(self) -> None:
        """Read, then command what is due, until the run is over."""
        began_s = self._clock.now_s()
        end_s = began_s + self._duration_s
        due_s = began_s
        while True:
            now_s = self._clock.now_s()
            if now_s >= end_s:
                return
            self._row(elapsed_s=now_s - began_s)
            due_s = max(due_s + self._experiment.poll_s, self._clock.now_s())
            self._clock.sleep(due_s - self._clock.now_s())

    def _row(self, *, elapsed_s: float | None = None, battery_v: float | None = None) -> None:
        """One poll; with `elapsed_s`, commands that are due follow its reading."""
        reading = self._brick.motors.tacho_deg(self._output)
        port = self._experiment.port
        self._dating.count(port, reading)
        self._dating.row(reading.received_s)
        if elapsed_s is not None:
            self._command(elapsed_s, reading.received_s)
        self._writer.append(
            {
                TIME: round(reading.received_s - self._zero_s, 6),
                power_column(port): self._in_force.power_pct,
                mode_column(port): self._in_force.mode,
                tacho_column(port): reading.value,
                BATTERY: battery_v,
            }
        )
        self._watch(reading.value)

    def _command(self, elapsed_s: float, stamp_s: float) -> None:
        wanted = None
        while self._waiting and self._waiting[0].start_s <= elapsed_s + 1e-9:
            wanted = self._waiting.popleft()
        if wanted is not None:
            self._in_force = wanted
            port = self._experiment.port
            reply = tell(self._brick, port, wanted.power_pct, wanted.mode)
            self._dating.command(port, reply, stamp_s)

    def _watch(self, tacho_deg: int) -> None:
        if self._start_deg is None:
            self._start_deg = tacho_deg
        most = self._experiment.most_turn_deg
        if most is not None and abs(tacho_deg - self._start_deg) > most:
            what = f"the motor turned {abs(tacho_deg - self._start_deg)} degrees, more than {most:g}"
            mend = "shorten the runs, or allow more by most_turn_deg"
            raise ExperimentError(what, where=f"port {self._experiment.port}", mend=mend)
