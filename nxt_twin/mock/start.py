"""Switch a mock brick on, with or without a world file; and a link to one in this process."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Protocol

from nxt_twin.brick.clock import Clock
from nxt_twin.mock.body.body import Body
from nxt_twin.mock.body.world import World, load_world
from nxt_twin.mock.errors import ServeError, WorldError
from nxt_twin.mock.firmware.firmware import Firmware
from nxt_twin.mock.named import world_file
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.link import MakeFailure, MockLink
from nxt_twin.mock.serve.profile import PROFILES, Profile

BodyChange = Callable[[Body], None]
"""What is done to a brick's body before it is switched on."""


class Bodies(Protocol):
    """Makes a brick's body of its surroundings, the file that they are from, and a seed; `ready` as for `switch_on`."""

    def __call__(self, world: World, file: Path | None, seed: int, *, ready: bool) -> Body:
        """The body."""
        ...


def bare_body(world: World, file: Path | None, seed: int, *, ready: bool) -> Body:
    """A brick on a desk, its motors free.

    Raises:
        WorldError: the brick is built into a robot.
        PlantError: a motor's plant is none.
    """
    if world.robot is not None:
        raise WorldError("holds a robot, which this cannot build", where=str(file or "world"))
    return world.body(seed, None if file is None else file.parent, ready=ready)


def switch_on(
    world: Path | None = None,
    seed: int = 0,
    before: Firmware | None = None,
    change: BodyChange = lambda _: None,
    *,
    bodies: Bodies = bare_body,
    ready: bool = True,
) -> Firmware:
    """A brick's firmware on its body, one tick old.

    Args:
        world: a world file, or the name of one of the tool's own; without it the brick is as LEGO ships it.
        seed: of the sensors' noise.
        before: the brick as it was when it was switched off; its files and name are kept.
        change: done to the body before.
        bodies: makes the body; `nxt_twin.world` knows one that builds robots.
        ready: load the compiled plants now, before any clock counts, not when a motor first moves.

    Raises:
        WorldError: the world file is none.
        PlantError: a motor's plant in it is none.
    """
    file = None if world is None else world_file(world)
    surroundings = World() if file is None else load_world(file)
    identity = surroundings.identity()
    if before is not None:
        identity = replace(identity, name=before.radio.brick_name)
    files = () if before is None else before.loader.files
    body = bodies(surroundings, file, seed, ready=ready)
    change(body)
    firmware = Firmware(body, identity, files)
    firmware.tick()
    return firmware


def profile_named(name: str | Profile) -> Profile:
    """A link's delays by name, or as they are.

    Raises:
        ServeError: there is no such profile.
    """
    if isinstance(name, Profile):
        return name
    if name not in PROFILES:
        raise ServeError("is no profile", where=repr(name), mend=f"one of {', '.join(PROFILES)}")
    return PROFILES[name]


def open_mock_link(
    clock: Clock,
    *,
    world: Path | None = None,
    seed: int = 0,
    profile: str = "none",
    change: BodyChange = lambda _: None,
    bodies: Bodies = bare_body,
    ready: bool = True,
    late: MakeFailure = TimeoutError,
    lost: MakeFailure = ConnectionError,
) -> MockLink:
    """A link to a brick that is switched on for it, in this process; what `mock:` means.

    Args:
        clock: what the brick's time follows; its ticks run while somebody uses the link.
        world: as for `switch_on`.
        seed: of noise, jitter and faults.
        profile: delays of the link.
        change: as for `switch_on`.
        bodies: as for `switch_on`.
        ready: as for `switch_on`.
        late: makes the exception for "nothing came in time".
        lost: makes the exception for "the other end is gone".

    Raises:
        WorldError: the world file is none.
        PlantError: a motor's plant in it is none.
        ServeError: there is no such profile.
    """
    delays = profile_named(profile)
    host = Host(switch_on(world, seed, change=change, bodies=bodies, ready=ready), clock)
    return MockLink(host, delays, seed=seed, late=late, lost=lost)
