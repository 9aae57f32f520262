"""A mock brick with a rig round it, in virtual time: where experiments are tried out without hardware."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import final

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.errors import LinkLostError, LinkTimeoutError
from nxt_twin.experiment.plan import (
    AngleSweep,
    DistanceSweep,
    Experiment,
    GradientSweep,
    MotorIdentification,
    TouchCycles,
    TwoSensors,
)
from nxt_twin.experiment.standin.hand import Hand
from nxt_twin.experiment.standin.rig import (
    Button,
    Diode,
    Echo,
    Rig,
    Transducers,
    place_button,
    place_light,
    place_transducers,
    place_ultrasonic,
)
from nxt_twin.mock.body.body import Body
from nxt_twin.mock.body.motors import MotorBank
from nxt_twin.mock.body.world import World, load_world
from nxt_twin.mock.firmware.firmware import Firmware
from nxt_twin.mock.named import world_file
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.link import MockLink
from nxt_twin.mock.start import BodyChange, profile_named
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.stepper import Stepper
from nxt_twin.recording.columns import PORTS, Port


@final
@dataclass(frozen=True)
class Workbench:
    """Everything that an experiment on the mock needs.

    Attributes:
        world: its surroundings as they were at first.
        folder: where paths of plant files start.
        brick: the mock, open.
        body: its motors and sensors.
        rig: what is round it.
        clock: virtual time.
        random: where the rig's chance comes from.
    """

    world: World
    folder: Path | None
    brick: Brick
    body: Body
    rig: Rig
    clock: VirtualClock
    random: Random


def workbench(
    world: World | Path | None = None,
    seed: int = 0,
    profile: str = "none",
    change: BodyChange = lambda _: None,
) -> Workbench:
    """Switch a mock brick on with nothing placed in its rig yet.

    Args:
        world: its surroundings, or their file; as LEGO ships it by default.
        seed: of all chance.
        profile: delays of its link.
        change: done to its body before it is switched on.

    Raises:
        WorldError: the world file is none.
        PlantError: a motor's plant in it is none.
        ServeError: there is no such profile.
    """
    given = world_file(world) if isinstance(world, Path) else world
    folder = given.parent if isinstance(given, Path) else None
    around = load_world(given) if isinstance(given, Path) else given or World()
    body = around.body(seed, folder)
    _stand_anywhere(body, Random(f"hubs {seed}"))  # noqa: S311 - places, not secrets
    change(body)
    firmware = Firmware(body, around.identity())
    firmware.tick()
    clock = VirtualClock()
    host, delays = Host(firmware, clock), profile_named(profile)
    link = MockLink(host, delays, seed=seed, late=LinkTimeoutError, lost=LinkLostError)
    chance = Random(seed)  # noqa: S311 - noise, not secrets
    return Workbench(around, folder, Brick(link, clock), body, Rig(), clock, chance)


def mount(bench: Workbench, port: Port, added_inertia_kg_m2: float) -> None:
    """Put a disc on a motor's hub, or with 0 take it off; the motors stand still where they were."""
    plants = [bench.world.plant(each, bench.folder) for each in PORTS]
    index = PORTS.index(port)
    slot = Slot(BASE_OWNER, "inertia")
    heavier = plants[index].values[slot] + added_inertia_kg_m2
    plants[index] = plants[index].with_values({slot: heavier})
    stepper = Stepper(plants)
    stepper.angle[:] = bench.body.motors.plants.angle
    bench.body.motors = MotorBank(stepper)


def _stand_anywhere(body: Body, chance: Random) -> None:
    """Put the hubs anywhere within a count: at a count's very edge, all that is rounded would err to one side."""
    angles = body.motors.plants.angle
    angles += [math.radians(chance.random()) for _ in angles]


def helper(bench: Workbench, experiment: Experiment) -> Hand:
    """Somebody who prepares what an experiment asks for: discs on the hub, and nothing else."""

    def put(inertia: float) -> None:
        if isinstance(experiment, MotorIdentification):
            mount(bench, experiment.port, inertia)

    return Hand(put)


def place_sensors(bench: Workbench, experiment: Experiment) -> None:
    """Put before the rig what the experiment asks for, as the source paper found it."""
    match experiment:
        case DistanceSweep() | AngleSweep():
            place_ultrasonic(bench.body, experiment.slot - 1, bench.rig, Echo(), bench.random)
        case GradientSweep():
            place_light(bench.body, experiment.slot - 1, bench.rig, Diode, bench.random)
        case TouchCycles():
            by_force = experiment.axis == "force_g"
            press, release, scatter = (57.0, 53.0, 0.3) if by_force else (2.11, 1.80, 2e-3)
            button = Button(press, release, scatter, bench.random)
            place_button(bench.body, experiment.slot - 1, bench.rig, experiment.axis, button)
        case TwoSensors():
            slots = (experiment.slot - 1, experiment.other_slot - 1)
            place_transducers(bench.body, slots, bench.rig, Transducers(), bench.random)
        case MotorIdentification():
            pass
