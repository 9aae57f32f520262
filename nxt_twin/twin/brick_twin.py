"""The twin of a whole brick: its motors on one battery, moved together from reading to reading."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import final

from nxt_twin.physics.late import effects_delay_s
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.recording.columns import DriveMode, Port
from nxt_twin.twin.batch import Batch
from nxt_twin.twin.bridge import COAST, Bridge, Hold, firmware_bridge
from nxt_twin.twin.candidates import DEFAULT_CANDIDATES
from nxt_twin.twin.motor import MotorTwin, ReadingEvidence
from nxt_twin.twin.records import MotorBelief
from nxt_twin.twin.settings import MotorNoise, Watch
from nxt_twin.twin.supply import Company, Drain, Lately, Supply

_SUPPLY_STEP_S = 0.005
"""How long the battery's voltage is held while the motors' current changes."""
_SAG = Slot("battery_sag", "internal")
_DRAIN = Slot("battery_drain", "drain")
_CELLS_OHM = 0.35
"""Six alkaline cells and the contacts between them; where a motor's plant has a sag of its own, it is 0."""


@final
@dataclass(frozen=True)
class TwinOptions:
    """How a brick's twin is made.

    Attributes:
        noise: what is random about its motors.
        watch: when readings are believed, and what an alarm needs.
        candidates: effects that are weighed while it runs; none to weigh nothing.
        bridge: what commands do.
        cells_ohm: the battery's internal resistance; None for that of six alkaline cells.
    """

    noise: MotorNoise = field(default_factory=MotorNoise)
    watch: Watch = field(default_factory=Watch)
    candidates: tuple[str, ...] = DEFAULT_CANDIDATES
    bridge: Bridge = firmware_bridge
    cells_ohm: float | None = None


@final
class BrickTwin:
    """Up to three motors; moments are of one clock that never goes back.

    Args:
        plants: the model of each motor.
        options: the rest.
        now_s: the moment to begin with.

    Raises:
        PlantError: the plants cannot stand side by side.
    """

    def __init__(
        self, plants: Mapping[Port, Plant], options: TwinOptions | None = None, now_s: float = 0.0
    ) -> None:
        self.options = options or TwinOptions()
        self._plants = dict(plants)
        self._commands: dict[Port, tuple[int, DriveMode]] = dict.fromkeys(plants, (0, "coast"))
        self._cells_ohm = _CELLS_OHM if self.options.cells_ohm is None else self.options.cells_ohm
        self._held: dict[Port, Hold] = dict.fromkeys(plants, Hold(0.0, 0.0, COAST))
        self._company = {port: Company() for port in plants}
        self._supply = Supply(_given_v(plants.values()), self._resistance_ohm())
        self._lately = Lately()
        self._motors = self._new_motors()
        self._batch = self._new_batch(now_s, now_s)

    @property
    def ports(self) -> tuple[Port, ...]:
        """The motors that it has."""
        return tuple(self._plants)

    @property
    def plants(self) -> Mapping[Port, Plant]:
        """The model of each motor."""
        return self._plants

    def plant_as_run(self, port: Port) -> Plant:
        """The model of a motor with the battery as it looks from that motor alone, for a diagnosis of it."""
        return self.as_run(port, self._plants[port])

    def as_run(self, port: Port, plant: Plant) -> Plant:
        """A model of that motor with the battery as it looks from that motor alone."""
        if _SAG.owner in plant.active or not self._cells_ohm:
            return plant
        return plant.with_effect(_SAG.owner, {_SAG.symbol: self._cells_ohm * self._company[port].times})

    @property
    def now_s(self) -> float:
        """The moment it has got to."""
        return self._batch.now_s

    @property
    def supply_v(self) -> float:
        """The battery's voltage without load, as estimated, V."""
        return self._supply.open_v

    def supply_at(self, from_s: float) -> float:
        """The battery's voltage without load at a moment, by what was read since, V."""
        return self._supply.at(from_s)

    def motor(self, port: Port) -> MotorTwin:
        """One motor's filters."""
        return self._motors[port]

    def command(
        self,
        port: Port,
        power_pct: int,
        mode: DriveMode,
        at_s: float,
        std_s: float = 0.0,
        *,
        fading: bool = False,
    ) -> tuple[Hold, ...]:
        """From `at_s` on, a motor is driven so; what its bridge makes of it, nothing where that is in force already.

        Args:
            port: of the motor.
            power_pct: commanded.
            mode: commanded.
            at_s: when it acts.
            std_s: how well that moment is known.
            fading: whether a motor that coasts is let go by the firmware's own coasting, which takes a while.
        """
        if self._commands[port] == (power_pct, mode):
            return ()
        before, _ = self._commands[port]
        self._commands[port] = (power_pct, mode)
        holds = self.options.bridge(power_pct, mode, before / 100.0 if fading else 0.0)
        self._batch.command(port, at_s, holds)
        if std_s > 0.0:
            self._motors[port].expect(at_s, std_s, self._held[port], holds[-1], self.supply_v)
        self._held[port] = holds[-1]
        return holds

    def commanded(self, port: Port) -> tuple[int, DriveMode]:
        """Power and mode in force on a port."""
        return self._commands[port]

    def move(self, to_s: float) -> None:
        """Let time pass for all motors."""
        moment_s = self._batch.now_s
        while moment_s < to_s:
            moment_s = min(to_s, moment_s + _SUPPLY_STEP_S)
            self._batch.advance(moment_s, self._supply.under(self._drawn_a()))
            self._lately.add(moment_s, self._drawn_a())

    def read_tacho(self, port: Port, taken_s: float, count: int, taken_std_s: float = 0.0) -> ReadingEvidence:
        """Compare a count, taken at `taken_s`, and learn from it."""
        self.move(taken_s)
        own_a = self._batch.drawn_a(self._motors[port].row)
        self._company[port].add(taken_s, own_a, self._drawn_a())
        return self._motors[port].read(self._batch, count, taken_std_s, taken_s)

    def read_battery(self, terminal_v: float, taken_s: float | None = None, age_s: float = 0.0) -> None:
        """Take a reading of the battery, which was measured at most `age_s` before `taken_s`; without that, now."""
        taken_s = self.now_s if taken_s is None else taken_s
        self.move(taken_s)
        self._supply.read(terminal_v, self._lately.since(taken_s - age_s), self.now_s)

    def place(self, port: Port, count: int, speed_rad_s: float = 0.0) -> None:
        """Begin anew at a count: the brick was away, and may have been switched off."""
        self._motors[port].place(self._batch, count, speed_rad_s)

    def speed_rad_s(self, port: Port) -> float:
        """The estimate of a motor's speed."""
        return math.radians(self.state(port).speed_deg_per_s)

    def forget_evidence(self, port: Port) -> None:
        """Let the model that is believed begin anew where the motor is."""
        self._motors[port].forget_evidence(self._batch)

    def begin_anew(self, port: Port) -> None:
        """Forget all that was learnt of a motor, apart from where it is."""
        self._motors[port].begin_anew(self._batch)

    def state(self, port: Port) -> MotorBelief:
        """The present estimate of a motor's state."""
        return self._motors[port].state(self._batch, *self._commands[port])

    def adopt(
        self,
        port: Port,
        plant: Plant,
        began_s: float,
        held: Sequence[tuple[float, Hold]] = (),
        *,
        told_of_battery: bool = True,
    ) -> None:
        """Put another model, for which time began at `began_s`, in a motor's place, and go on where it is.

        A battery resistance that is new to the motor's model belongs to the battery of all motors. The battery
        keeps its present resistance unless it is `told_of_battery`. What has changed slowly since then, such as how
        warm its winding is, follows from what its bridge `held`.
        """
        motors, batch = self._motors, self._batch
        if _SAG.owner in plant.active and _SAG.owner not in self._plants[port].active:
            if told_of_battery:
                self._cells_ohm = plant.values[_SAG] / self._company[port].times
            plant = plant.without({_SAG.owner})
        self._plants[port] = plant
        self._supply = self._supply.behind(self._resistance_ohm(), _drain_of(plant, began_s))
        self._motors = self._new_motors()
        self._batch = self._new_batch(batch.now_s, began_s)
        self._batch.go_on_from(batch)
        lasted = {each: batch.lasted(motor.row) for each, motor in motors.items() if each != port}
        lasted[port] = self._lasted(plant, began_s, held)
        for each, motor in self._motors.items():
            motor.follow(motors[each], batch, self._batch)
            self._batch.set_lasting(motor.every_row, lasted[each])

    def _lasted(self, plant: Plant, began_s: float, held: Sequence[tuple[float, Hold]]) -> dict[int, float]:
        """Where the slow states of a model have got to, by a free run of it."""
        batch = Batch([plant], ["a"], _delays_s([plant]), self.options.noise.torque_time_s, began_s, began_s)
        if batch.lasted(0):
            for at_s, hold in held:
                batch.command("a", at_s, (hold,))
            batch.advance(self.now_s, self._supply.open_v)
        return batch.lasted(0)

    def _drawn_a(self) -> float:
        return sum(self._batch.drawn_a(motor.row) for motor in self._motors.values())

    def _resistance_ohm(self) -> float:
        """What all motors draw together passes through it; none where a motor's own plant has it."""
        sagging = any(_SAG.owner in plant.active for plant in self._plants.values())
        return 0.0 if sagging else self._cells_ohm

    def _new_motors(self) -> dict[Port, MotorTwin]:
        options, row, motors = self.options, 0, {}
        for turn, (port, plant) in enumerate(self._plants.items()):
            motor = MotorTwin(port, plant, options.noise, options.watch, row, options.candidates, turn)
            motors[port] = motor
            row += len(motor.rows)
        return motors

    def _new_batch(self, now_s: float, began_s: float) -> Batch:
        plants: list[Plant] = []
        ports: list[Port] = []
        for port, motor in self._motors.items():
            plants += motor.rows
            ports += [port] * len(motor.rows)
        return Batch(plants, ports, _delays_s(plants), self.options.noise.torque_time_s, now_s, began_s)


def _drain_of(plant: Plant, began_s: float) -> Drain:
    return Drain(plant.values.get(_DRAIN, 0.0), began_s)


def _given_v(plants: Iterable[Plant]) -> float:
    return max(plant.values[Slot(BASE_OWNER, "supply_v")] for plant in plants)


def _delays_s(plants: Sequence[Plant]) -> list[float]:
    known: dict[int, float] = {}
    return [known.setdefault(id(plant), effects_delay_s(plant)) for plant in plants]
