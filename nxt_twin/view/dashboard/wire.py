"""Polls and events as lines of text, from the loop's process to the dashboard's own."""

from __future__ import annotations

import json
from typing import Any, Final

from nxt_twin.twin.records import Event, Innovation, MotorBelief, Tick
from nxt_twin.view.dashboard.scene import WorldMessage, message_of, plain_values

_TICK: Final = "t"
_EVENT: Final = "e"
_DROPPED: Final = "d"

Message = Tick | Event | WorldMessage | int
"""A poll, an event, something of a robot's world, or how many polls had to be dropped since the last message."""


def line_of(message: Message) -> bytes:
    """A message as one line, which ends in a newline."""
    row: tuple[object, ...]
    if isinstance(message, Tick):
        row = (
            _TICK,
            message.number,
            message.sent_s,
            message.received_s,
            message.battery_v,
            message.link_up,
            [_motor_row(motor) for motor in message.motors],
            [_innovation_row(innovation) for innovation in message.innovations],
        )
    elif isinstance(message, Event):
        row = (
            _EVENT,
            message.time_s,
            message.kind,
            message.words,
            message.port,
            message.channel,
            message.onset_s,
            message.strength,
        )
    elif isinstance(message, int):
        row = (_DROPPED, message)
    else:
        row = plain_values(message)
    return json.dumps(row, separators=(",", ":"), default=_plain).encode() + b"\n"


def read(line: bytes) -> Message:
    """What `line_of` made into a line.

    Raises:
        ValueError: the line is none of `line_of`'s.
    """
    kind, *row = json.loads(line)
    if kind == _TICK:
        number, sent_s, received_s, battery_v, link_up, motors, innovations = row
        return Tick(
            number=number,
            sent_s=sent_s,
            received_s=received_s,
            motors=tuple(MotorBelief(*motor) for motor in motors),
            innovations=tuple(Innovation(*innovation) for innovation in innovations),
            battery_v=battery_v,
            link_up=link_up,
        )
    if kind == _EVENT:
        return Event(*row)
    if kind == _DROPPED:
        return int(row[0])
    if (told := message_of(kind, row)) is not None:
        return told
    raise ValueError(f"a line of an unknown kind: {kind}")


def _plain(value: Any) -> Any:  # noqa: ANN401 - whatever JSON does not know
    """A number of numpy as Python's own."""
    return value.item()


def _motor_row(motor: MotorBelief) -> tuple[Any, ...]:
    return (
        motor.port,
        motor.power_pct,
        motor.mode,
        motor.angle_deg,
        motor.speed_deg_per_s,
        motor.current_a,
        motor.unknown_torque_nm,
        motor.unknown_torque_std_nm,
        dict(motor.effects),
    )


def _innovation_row(innovation: Innovation) -> tuple[Any, ...]:
    return (
        innovation.time_s,
        innovation.channel,
        innovation.unit,
        innovation.measured,
        innovation.predicted,
        innovation.variance,
        innovation.accepted,
    )
