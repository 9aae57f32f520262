"""What opens the URLs beyond those of `nxt_twin.brick.open`: ``mock:``, a mock brick inside this program."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final
from urllib.parse import parse_qsl

from nxt_twin.brick.clock import Clock
from nxt_twin.brick.errors import LinkLostError, LinkTimeoutError, LinkUrlError
from nxt_twin.brick.link import Link
from nxt_twin.brick.open import Opener
from nxt_twin.errors import CaseError
from nxt_twin.mock.serve.profile import PROFILES

if TYPE_CHECKING:
    from nxt_twin.mock.body.body import Body
    from nxt_twin.mock.body.world import World
    from nxt_twin.mock.start import Bodies


_SEED: Final = re.compile(r"[0-9]{1,18}")


def open_mock(address: str, clock: Clock, *, ready: bool = True, bodies: Bodies | None = None) -> Link:
    """Switch on a mock brick.

    Args:
        address: empty, or ``?`` and any of ``world=FILE``, ``seed=N``, ``profile=NAME`` and ``conceal=SEED`` or
            ``conceal=FILE``, joined by ``&``.
        clock: what the brick's time follows.
        ready: load what motors need in order to move; it takes half a second.
        bodies: makes the brick's body; by default `world_bodies`.

    Raises:
        LinkUrlError: the address is not of that form, or names no profile.
        WorldError: the world file is none.
        CaseError: what is to be concealed cannot be.
    """
    # Brings in the plants, which the other URLs do not need.
    from nxt_twin.mock.start import open_mock_link

    wanted = mock_options(address)
    world = wanted.get("world")
    return open_mock_link(
        clock,
        world=None if world is None else Path(world),
        seed=int(wanted.get("seed", "0")),
        profile=wanted.get("profile", "none"),
        change=concealing(wanted.get("conceal")),
        bodies=bodies or world_bodies,
        ready=ready,
        late=LinkTimeoutError,
        lost=LinkLostError,
    )


def concealing(secret: str | None) -> Callable[[Body], None]:
    """What puts a secret, named by a seed or a file, into a mock brick's body; without one, nothing.

    Raises:
        CaseError: it cannot be concealed.
    """
    if secret is None:
        return lambda _: None
    from nxt_twin.blind.body import hiding
    from nxt_twin.blind.secret import secret_of

    hide = hiding(secret_of(secret))

    def conceal(body: Body) -> None:
        from nxt_twin.world.plants import WorldPlants

        plants = body.motors.plants
        if isinstance(plants, WorldPlants) and plants.drives_joint(0):
            mend = "give it another plant under motors:, or change the robot by like:"
            raise CaseError(
                "nothing can be concealed in a motor that moves a robot", where="motor A", mend=mend
            )
        hide(body)

    return conceal


def world_bodies(world: World, file: Path | None, seed: int, *, ready: bool) -> Body:
    """A mock brick's body; where the world file holds a robot, on that robot in its scene.

    Raises:
        WorldError: the robot or the scene is none, or PyBullet is not installed.
        PlantError: a motor's plant is none.
    """
    if world.robot is None:
        from nxt_twin.mock.start import bare_body

        return bare_body(world, file, seed, ready=ready)
    from nxt_twin.world.bodies import robot_body

    return robot_body(world, file, seed)


OPENERS: Final[Mapping[str, Opener]] = MappingProxyType({"mock": open_mock})
"""To be passed to `open_link` and `open_brick`."""

LOOKING_OPENERS: Final[Mapping[str, Opener]] = MappingProxyType({"mock": partial(open_mock, ready=False)})
"""For who commands no motor."""


def mock_options(address: str) -> dict[str, str]:
    """What follows ``mock:``, as `open_mock` takes it.

    Raises:
        LinkUrlError: it is not of that form.
    """
    try:
        options = dict(parse_qsl(address.removeprefix("?"), strict_parsing=True)) if address else {}
    except ValueError:
        options = {address: ""}
    if (
        not options.keys() <= {"world", "seed", "profile", "conceal"}
        or not _SEED.fullmatch(options.get("seed", "0"))
        or options.get("profile", "none") not in PROFILES
    ):
        raise LinkUrlError(
            "is no mock brick's URL",
            where=f"mock:{address}",
            mend="such as mock: or mock:?world=FILE&seed=1&profile=usb",
        )
    return options
