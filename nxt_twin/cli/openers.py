"""What opens the URLs beyond those of `nxt_twin.brick.open`: ``mock:``, a mock brick inside this program."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Final
from urllib.parse import parse_qsl

from nxt_twin.brick.clock import Clock
from nxt_twin.brick.errors import LinkLostError, LinkTimeoutError, LinkUrlError
from nxt_twin.brick.link import Link
from nxt_twin.brick.open import Opener


def open_mock(address: str, clock: Clock) -> Link:
    """Switch on a mock brick.

    Args:
        address: empty, or ``?`` and any of ``world=FILE``, ``seed=N`` and ``profile=NAME``, joined by ``&``.
        clock: what the brick's time follows.

    Raises:
        LinkUrlError: the address is not of that form.
        WorldError: the world file is none.
        ServeError: there is no such profile.
    """
    # Brings in the compiled plants, which the other URLs do not need.
    from nxt_twin.mock.start import open_mock_link

    wanted = mock_options(address)
    world = wanted.get("world")
    return open_mock_link(
        clock,
        world=None if world is None else Path(world),
        seed=int(wanted.get("seed", "0")),
        profile=wanted.get("profile", "none"),
        late=LinkTimeoutError,
        lost=LinkLostError,
    )


OPENERS: Final[Mapping[str, Opener]] = MappingProxyType({"mock": open_mock})
"""To be passed to `open_link` and `open_brick`."""


def mock_options(address: str) -> dict[str, str]:
    """What follows ``mock:``, as `open_mock` takes it.

    Raises:
        LinkUrlError: it is not of that form.
    """
    try:
        options = dict(parse_qsl(address.removeprefix("?"), strict_parsing=True)) if address else {}
    except ValueError:
        options = {address: ""}
    if not options.keys() <= {"world", "seed", "profile"} or not options.get("seed", "0").isdecimal():
        raise LinkUrlError(
            "is no mock brick's URL", where=f"mock:{address}", mend="such as mock: or mock:?world=FILE&seed=1"
        )
    return options
