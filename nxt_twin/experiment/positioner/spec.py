"""How a user specifies a positioner: ``hand``, ``rail:b,mm_per_deg=0.3``, ``nx100:HOST,along=z``."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Final, Literal, final, get_args

from nxt_twin.brick.errors import LinkUrlError
from nxt_twin.brick.url import host_and_port
from nxt_twin.errors import ProgramError
from nxt_twin.experiment.positioner.nx100 import RobotSetUp
from nxt_twin.experiment.positioner.nx100_session import TCP_PORT
from nxt_twin.experiment.positioner.positioner import PositionerAxis
from nxt_twin.experiment.positioner.rail import RailSetUp
from nxt_twin.recording.columns import PORTS
from nxt_twin.recording.source import nearest_name

PositionerKind = Literal["hand", "rail", "nx100"]

_KINDS: Final = get_args(PositionerKind)
_AXES: Final = get_args(PositionerAxis)
_CHOICES: Final[Mapping[str, tuple[str, ...]]] = {
    "homing": ("here", "touch"),
    "along": ("x", "y", "z", "rx", "ry", "rz"),
}


@final
@dataclass(frozen=True)
class PositionerSpec:
    """What moves one axis.

    Attributes:
        kind: hand, rail or robot.
        axis: which; None is the only one, or all that have no other.
        address: the motor's port of a rail, the controller's host.
        port: the controller's TCP port.
        set_up: how a rail or robot is set up; None for a hand.
        text: what the user wrote.
    """

    kind: PositionerKind
    axis: PositionerAxis | None = None
    address: str = ""
    port: int = TCP_PORT
    set_up: RailSetUp | RobotSetUp | None = None
    text: str = "hand"


def read_spec(text: str) -> PositionerSpec:
    """Read ``[AXIS=]hand``, ``[AXIS=]rail:PORT,KEY=VALUE,…`` or ``[AXIS=]nx100:HOST[:PORT],KEY=VALUE,…``.

    The keys are the fields of `RailSetUp` and `RobotSetUp`.

    Raises:
        ProgramError: it is none of these, or has a key or value that has no meaning.
    """
    axis: PositionerAxis | None = None
    head, equals, rest = text.partition("=")
    if equals and head in _AXES:
        axis, text = head, rest  # type: ignore[assignment]
    kind, _, tail = text.partition(":")
    address, _, options = tail.partition(",")
    if kind == "hand" and not tail:
        return PositionerSpec("hand", axis)
    if kind == "rail" and address in PORTS:
        given = _options(options, RailSetUp, text)
        if "mm_per_deg" not in given:
            raise ProgramError("has no mm_per_deg", where=text, mend="such as rail:b,mm_per_deg=0.3")
        return PositionerSpec("rail", axis, address, set_up=RailSetUp(**given), text=text)
    if kind == "nx100" and address:
        host, port = _controller(address, text)
        set_up = RobotSetUp(**_options(options, RobotSetUp, text))
        return PositionerSpec("nx100", axis, host, port, set_up, text)
    mend = "such as hand, rail:b,mm_per_deg=0.3 or nx100:192.168.255.1,along=z,value_now=100"
    raise ProgramError(f"is no positioner of kind {', '.join(_KINDS)}", where=text, mend=mend)


def _controller(address: str, where: str) -> tuple[str, int]:
    if ":" not in address:
        return address, TCP_PORT
    try:
        return host_and_port(address)
    except LinkUrlError:
        raise ProgramError(f"'{address}' is not HOST:PORT", where=where) from None


def _options(text: str, of: type[RailSetUp] | type[RobotSetUp], where: str) -> dict[str, Any]:
    types = {field.name: str(field.type) for field in fields(of)}
    found: dict[str, Any] = {}
    for part in filter(None, text.split(",")):
        key, _, value = part.partition("=")
        if key not in types:
            raise ProgramError(
                f"unknown key '{key}'", where=where, mend=f"nearest known: {nearest_name(key, types)}"
            )
        if key in _CHOICES:
            if value not in _CHOICES[key]:
                raise ProgramError(f"{key} is none of {', '.join(_CHOICES[key])}", where=where)
            found[key] = value
            continue
        try:
            finite = math.isfinite(float(value))  # of whole numbers too: one of 400 digits is none
            found[key] = int(value) if finite and types[key] == "int" else float(value)
        except ValueError:
            raise ProgramError(f"{key}: '{value}' is no number", where=where) from None
        if not finite:
            raise ProgramError(f"{key}: '{value}' is not finite", where=where)
    return found
