"""The commands to the motors while the twin watches them."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from typing import Protocol, final

from nxt_twin.recording.columns import DriveMode, Port
from nxt_twin.recording.program import MotorCommand, MotorProgram, Run, Segment, commands

Told = tuple[int, DriveMode]

_COAST: Told = (0, "coast")


class Driver(Protocol):
    """Says what to command, whenever it is asked."""

    @property
    def ports(self) -> tuple[Port, ...]:
        """The motors that it commands."""
        ...

    def at(self, time_s: float, counts: Mapping[Port, int]) -> Mapping[Port, Told]:
        """What should be in force now, by what the encoders last said."""
        ...


@final
class ProgramDriver:
    """Runs a motor program, over and over; all its motors alike.

    Args:
        program: what to run.
    """

    def __init__(self, program: MotorProgram) -> None:
        self._program = program
        self._commands: list[MotorCommand] = []
        self._starts_s: list[float] = []
        end_s = 0.0
        for run in program.runs:
            self._starts_s.append(end_s)
            for each in commands(run):
                self._commands.append(MotorCommand(end_s + each.start_s, each.power_pct, each.mode))
            end_s += run.duration_s
            self._commands.append(MotorCommand(end_s, 0, "coast"))
            end_s += program.rest_s
        self.duration_s = end_s
        self._times_s = [each.start_s for each in self._commands]
        self._from: dict[Port, int] = {}
        self._run = -1
        self._ended: set[Port] = set()

    @property
    def ports(self) -> tuple[Port, ...]:
        """The motors that it commands."""
        return self._program.ports

    def at(self, time_s: float, counts: Mapping[Port, int]) -> Mapping[Port, Told]:
        """What should be in force now; a motor that has turned too far coasts until the next run."""
        round_number, within_s = divmod(time_s, self.duration_s)
        number = int(round_number) * len(self._starts_s) + bisect_right(self._starts_s, within_s)
        if number != self._run:
            self._run, self._from, self._ended = number, dict(counts), set()
        command = self._commands[bisect_right(self._times_s, within_s) - 1]
        most = self._program.most_turn_deg
        for port, count in counts.items():
            if most is not None and abs(count - self._from.setdefault(port, count)) > most:
                self._ended.add(port)
        told: Told = (command.power_pct, command.mode)
        return {port: _COAST if port in self._ended else told for port in self.ports}


@final
class Detour:
    """Drives as another driver does, apart from programs that are run once in between.

    Args:
        usual: what drives otherwise.
    """

    def __init__(self, usual: Driver) -> None:
        self._usual = usual
        self._other: ProgramDriver | None = None
        self._from_s = 0.0

    @property
    def ports(self) -> tuple[Port, ...]:
        """The motors that it commands."""
        return self._usual.ports

    def run(self, program: MotorProgram, from_s: float) -> float:
        """Run a program once, from a moment on, while motors that it does not drive coast; when it will be over."""
        self._other, self._from_s = ProgramDriver(program), from_s
        return from_s + self._other.duration_s

    def at(self, time_s: float, counts: Mapping[Port, int]) -> Mapping[Port, Told]:
        """What should be in force now."""
        if self._other is None:
            return self._usual.at(time_s, counts)
        since_s = time_s - self._from_s
        if since_s >= self._other.duration_s:
            self._other = None
            return self._usual.at(time_s, counts)
        return {**dict.fromkeys(self.ports, _COAST), **self._other.at(since_s, counts)}


def excitation(ports: tuple[Port, ...]) -> MotorProgram:
    """What shows most of a motor in half a minute: steps both ways, slow ramps through zero, coasting, rests."""
    steps = [50, -70, 30, -40, 90, -90, 20, -25, 65]
    segments = [Segment(duration_s=0.5)]
    segments += [Segment(duration_s=0.9, power_pct=power) for power in steps]
    segments += [Segment(duration_s=0.6, mode="coast"), Segment(duration_s=0.4)]
    for end in (60, -60):
        segments += [
            Segment(duration_s=2.5, power_pct=0, end_power_pct=end),
            Segment(duration_s=2.5, power_pct=end, end_power_pct=0),
        ]
    segments += [Segment(duration_s=0.5, power_pct=power) for power in (80, -80, 40, -40, 100, -60)]
    segments += [Segment(duration_s=0.7, mode="brake"), Segment(duration_s=0.8)]
    return MotorProgram(
        name="excitation",
        why="steps, ramps, reversals and rests, so that a model that lacks something shows it",
        ports=ports,
        runs=(Run(name="excitation", segments=tuple(segments)),),
    )
