"""A true motor of any family before and after, and the host that records it."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, Final, final

from numpy.random import Generator

from nxt_twin.blind.bench import draw_commands, draw_motor
from nxt_twin.blind.case import NOMINAL
from nxt_twin.blind.effects.concealed import Situation
from nxt_twin.blind.effects.library import EFFECTS
from nxt_twin.blind.excitation import FAMILIES as INPUTS
from nxt_twin.blind.families.foreign import Foreign, draw_scripts
from nxt_twin.blind.families.habits import draw_habits
from nxt_twin.blind.families.host import drive_machine, write_rows
from nxt_twin.blind.families.motors import draw_baseline
from nxt_twin.blind.families.motors import draw_motor as draw_numbers
from nxt_twin.blind.families.numbers import Chain
from nxt_twin.blind.families.programs import FIRST_PROGRAMS, draw_programs
from nxt_twin.blind.families.setting import DrawnCase
from nxt_twin.blind.families.table import BRISTLE, FOREIGN
from nxt_twin.blind.kinds import Size
from nxt_twin.blind.polling import LinkName
from nxt_twin.blind.record import take
from nxt_twin.blind.truth.sensing import Sensing
from nxt_twin.recording.recording import Recording

DURATION_S: Final = 8.0
RECORDINGS: Final = 2
"""On each side."""

SHOWING: Final = ("steps", "reversals")
LINKS: Final[tuple[LinkName, ...]] = ("usb", "bluetooth")


@final
@dataclass(frozen=True)
class BenchTruth:
    """A motor and its measuring chain, in a family's own types."""

    motor: Any
    chain: Any

    def scaled(self, names: tuple[str, ...], factor: float) -> BenchTruth:
        """With these fields of the motor multiplied, as far as it has them."""
        own = {field.name for field in fields(self.motor)} & set(names)
        return replace(
            self, motor=replace(self.motor, **{name: factor * getattr(self.motor, name) for name in own})
        )


class Bench(ABC):
    """One motor on its bench."""

    truth: BenchTruth
    """As it is drawn, nothing hidden."""

    plant: Mapping[str, float]
    """The keys of its plant file, some of them off."""

    sidecar: Mapping[str, float]
    """What stands beside each recording."""

    @abstractmethod
    def with_effect(
        self, rng: Generator, truth: BenchTruth, effect: str, size: Size
    ) -> tuple[BenchTruth, Mapping[str, float]]:
        """`truth` with an effect, and the effect's true parameters."""

    @abstractmethod
    def record(self, rng: Generator, truth: BenchTruth, name: str) -> tuple[Recording, ...]:
        """Recordings of one side, `name`-1.csv and so on."""


@final
class BristleBench(Bench):
    """Of the first family."""

    def __init__(self, rng: Generator) -> None:
        self.truth = BenchTruth(draw_motor(rng), Sensing())
        self.plant, self.sidecar = NOMINAL, {}
        self._link = LINKS[int(rng.integers(len(LINKS)))]

    def with_effect(
        self, rng: Generator, truth: BenchTruth, effect: str, size: Size
    ) -> tuple[BenchTruth, Mapping[str, float]]:
        """As `Bench.with_effect`."""
        at = Situation(rng, size, truth.motor, RECORDINGS, DURATION_S, (0.5,) * RECORDINGS)
        drawn = EFFECTS[effect].sample(at)
        return BenchTruth(
            replace(truth.motor, **drawn.motor), replace(truth.chain, **drawn.sensing)
        ), drawn.params

    def record(self, rng: Generator, truth: BenchTruth, name: str) -> tuple[Recording, ...]:
        """As `Bench.record`."""
        inputs = [str(rng.choice(SHOWING)), str(rng.choice([one for one in INPUTS if one not in SHOWING]))]
        runs = [draw_commands(rng, each, self._link, DURATION_S, float(rng.random()), 0.0) for each in inputs]
        return tuple(
            take(rng, f"{name}-{k}.csv", truth.motor, truth.chain, run).recording
            for k, run in enumerate(runs, start=1)
        )


@final
class ForeignBench(Bench):
    """Of any other family."""

    def __init__(self, rng: Generator, family: Foreign) -> None:
        self._family = family
        habits = draw_habits(
            rng, family.steps_deg, longest_s=family.longest_s, duration_s=DURATION_S, least_recordings=1
        )
        self._habits = replace(habits, recordings=RECORDINGS)
        self.truth = BenchTruth(draw_numbers(rng), Chain())
        self.plant = draw_baseline(rng, self.truth.motor)
        self.sidecar = {} if habits.step_deg == 1.0 else {"tacho_step_deg": habits.step_deg}

    def with_effect(
        self, rng: Generator, truth: BenchTruth, effect: str, size: Size
    ) -> tuple[BenchTruth, Mapping[str, float]]:
        """As `Bench.with_effect`."""
        at = DrawnCase(
            rng, size, truth.motor, RECORDINGS, DURATION_S, self._habits.poll_s, (0.5,) * RECORDINGS, ()
        )
        (hideable,) = self._family.chosen((effect,))
        drawn = hideable.draw(at)
        return BenchTruth(
            replace(truth.motor, **drawn.numbers), replace(truth.chain, **drawn.chain)
        ), drawn.params

    def record(self, rng: Generator, truth: BenchTruth, name: str) -> tuple[Recording, ...]:
        """As `Bench.record`."""
        found = []
        every_s = self._family.command_every_s
        programs = draw_programs(rng, self._habits.recordings, coasts=False, among=FIRST_PROGRAMS)
        scripts = draw_scripts(rng, self._habits, programs, "off", every_s)
        for k, script in enumerate(scripts, start=1):
            machine = self._family.build(truth.motor, math.radians(script.start_deg), 0.0)
            driven = drive_machine(machine, truth.chain, script, self._habits.step_deg, every_s)
            rows = write_rows(rng, script, truth.chain, self._habits, driven)
            found.append(replace(rows.recording, name=f"{name}-{k}.csv"))
        return tuple(found)


def bench_of(rng: Generator, family: str) -> Bench:
    """A motor of a family, drawn."""
    return BristleBench(rng) if family == BRISTLE else ForeignBench(rng, FOREIGN[family])
