"""Why a tacho limit is overrun: what is the firmware's, and what the motor's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import firmware_protocol as fp
from firmware_protocol import MotorMode, RunState
from nxt_twin.mock.body.body import Body
from nxt_twin.mock.body.world import World
from nxt_twin.mock.firmware.channel import Transport
from nxt_twin.mock.firmware.firmware import Firmware
from nxt_twin.recording.configs import load_plant_config

LIMIT: Final = 360
POWER: Final = 75
_PORT: Final = 0
_REST_TICKS: Final = 5_000
_RAMP_DOWN_TICKS: Final = 80


@dataclass(frozen=True)
class Overrun:
    """Counts of one run to a limit.

    Attributes:
        at_limit: when the firmware gives up driving.
        driven: when the power has run down, 1 % a tick.
        at_rest: in the end.
        let_go: in the end, if the bridge opens at the limit.
        braked: in the end, if the bridge shorts the winding at the limit.
    """

    at_limit: int
    driven: int
    at_rest: int
    let_go: int
    braked: int


def overrun(plant: dict[str, Any], mode: MotorMode = MotorMode.ON | MotorMode.BRAKE) -> Overrun:
    """Run a motor to the limit, and let it end in three ways.

    Args:
        plant: the motor's keys.
        mode: of the run; the brake bit shorts the winding between pulses.
    """
    firmware, body = _at_limit(plant, mode)
    at_limit = firmware.outputs.motors[_PORT].count
    for _ in range(_RAMP_DOWN_TICKS):
        firmware.tick()
    driven = firmware.outputs.motors[_PORT].count
    for _ in range(_REST_TICKS):
        firmware.tick()
    let_go, braked = (_ended(plant, mode, brake=brake) for brake in (False, True))
    return Overrun(at_limit, driven, body.tacho_counts()[_PORT], let_go, braked)


def _at_limit(plant: dict[str, Any], mode: MotorMode) -> tuple[Firmware, Body]:
    world = World(motors={"a": plant})
    body = world.body()
    firmware = Firmware(body, world.identity())
    drive = fp.SetOutputState(_PORT, POWER, mode, 0, 0, RunState.RUNNING, LIMIT)
    firmware.receive(Transport.USB, fp.encode_request(drive))
    firmware.tick()
    while firmware.outputs.motors[_PORT].run_state == RunState.RUNNING:
        firmware.tick()
    return firmware, body


def _ended(plant: dict[str, Any], mode: MotorMode, *, brake: bool) -> int:
    _, body = _at_limit(plant, mode)
    body.set_motor(_PORT, 0, brake=brake)
    for _ in range(_REST_TICKS):
        body.step()
    return body.tacho_counts()[_PORT]


def report() -> list[str]:
    """The counts for the consistent and the printed friction of the paper, as lines to print."""
    lines = [f"a limit of {LIMIT} at power {POWER}; counts at the limit, with the power run down, at rest;"]
    lines += ["and at rest if the bridge opened, or braked, at the limit"]
    for name in ("nxt_motor", "nxt_motor_as_printed"):
        plant = load_plant_config(name)
        friction_nm = plant["coulomb_friction_nm"]
        for mode, word in ((MotorMode.ON | MotorMode.BRAKE, "brake bit"), (MotorMode.ON, "no brake bit")):
            seen = overrun(plant, mode)
            lines.append(
                f"{name} (friction {friction_nm:g} N·m), {word}: {seen.at_limit}, {seen.driven}, {seen.at_rest};"
                f" {seen.let_go}, {seen.braked}"
            )
    return lines


if __name__ == "__main__":
    print("\n".join(report()))
