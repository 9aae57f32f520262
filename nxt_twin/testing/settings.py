"""The settings of a test's mock brick: the world round it, the link's delays, faults."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, Final, final

import yaml

from nxt_twin.errors import NxtTwinError
from nxt_twin.mock.body.body import Body
from nxt_twin.mock.body.ultrasonic import UltrasonicBody
from nxt_twin.mock.serve.profile import PROFILES, Profile

_WORLD_FILE: Final = "nxt_world.yaml"
_LINK_FAULTS: Final = frozenset({"drop", "corrupt"})
_DELAYS: Final = frozenset(field.name for field in fields(Profile)) - _LINK_FAULTS


class MarkerError(NxtTwinError):
    """A marker on a test that asks for what there is not."""


@final
@dataclass(frozen=True)
class MockSettings:
    """All that a test can ask for.

    Attributes:
        world: a world file (docs/mock.md); None is the brick as LEGO ships it.
        profile: delays and faults of the link.
        seed: of noise, jitter and faults.
        silent: ports 1 to 4 whose digital sensor acknowledges and says nothing.
        absent: ports 1 to 4 whose digital sensor does not acknowledge.
    """

    world: Path | None = None
    profile: Profile = PROFILES["none"]
    seed: int = 0
    silent: tuple[int, ...] = ()
    absent: tuple[int, ...] = ()

    def change(self, body: Body) -> None:
        """Put the sensors' faults into a body before the brick is switched on.

        Raises:
            MarkerError: a port has no digital sensor.
        """
        for port in self.silent:
            _digital(body, port).answering = False
        for port in self.absent:
            _digital(body, port).acknowledging = False


def _digital(body: Body, port: int) -> UltrasonicBody:
    sensor = body.sensors[port - 1] if 1 <= port <= len(body.sensors) else None
    if not isinstance(sensor, UltrasonicBody):
        mend = "name the port of an ultrasonic sensor, by default 4"
        raise MarkerError("has no digital sensor", where=f"nxt_faults, port {port}", mend=mend)
    return sensor


def with_world(
    settings: MockSettings, file: str | Path | None, keys: Mapping[str, Any], *, here: Path, scratch: Path
) -> MockSettings:
    """Settings with a world.

    Args:
        settings: the rest.
        file: a world file, relative to the test's own.
        keys: a world's keys, in place of a file.
        here: the folder of the test's file.
        scratch: where a file can be made.

    Raises:
        MarkerError: both are given, or none.
    """
    if (file is None) == (not keys):
        raise MarkerError("takes a file or keys", where="nxt_world", mend='such as nxt_world("desk.yaml")')
    if file is not None:
        return replace(settings, world=here / file)
    path = scratch / _WORLD_FILE
    path.write_text(yaml.safe_dump(dict(keys)), encoding="utf-8")
    return replace(settings, world=path)


def with_latency(settings: MockSettings, name: str, delays: Mapping[str, float]) -> MockSettings:
    """Settings with a link's delays: a profile's by name, and others in their place.

    Raises:
        MarkerError: there is no such profile or delay.
    """
    if name not in PROFILES:
        mend = f"one of {', '.join(PROFILES)}"
        raise MarkerError(f"there is no profile {name!r}", where="nxt_latency", mend=mend)
    _check_known(delays, _DELAYS, "nxt_latency")
    faults = {key: getattr(settings.profile, key) for key in _LINK_FAULTS}
    return replace(settings, profile=replace(PROFILES[name], **faults, **delays))


def with_faults(settings: MockSettings, faults: Mapping[str, Any]) -> MockSettings:
    """Settings with faults: `drop` and `corrupt` for the link's bytes, `silent` and `absent` for sensors, `seed`.

    Raises:
        MarkerError: there is no such fault.
    """
    _check_known(faults, _LINK_FAULTS | {"seed", "silent", "absent"}, "nxt_faults")
    link = {key: float(value) for key, value in faults.items() if key in _LINK_FAULTS}
    return replace(
        settings,
        profile=replace(settings.profile, **link),
        seed=faults.get("seed", settings.seed),
        silent=_ports(faults.get("silent", ())),
        absent=_ports(faults.get("absent", ())),
    )


def _ports(given: int | tuple[int, ...]) -> tuple[int, ...]:
    return (given,) if isinstance(given, int) else tuple(given)


def _check_known(given: Mapping[str, Any], known: frozenset[str], marker: str) -> None:
    if unknown := sorted(given.keys() - known):
        mend = f"one of {', '.join(sorted(known))}"
        raise MarkerError(f"there is no {', '.join(unknown)}", where=marker, mend=mend)
