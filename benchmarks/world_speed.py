"""Cost of a second of a robot's world on one core: a tribot with two motors and four sensors, driving in a
pen."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

import firmware_protocol as fp
from nxt_twin.mock.firmware.channel import Transport
from nxt_twin.mock.firmware.firmware import Firmware
from nxt_twin.world.arena import Arena, open_arena
from nxt_twin.world.load import load_setting

AIM: Final = 10.0
"""Times real time at 1 kHz physics."""
_TICKS: Final = 1000
_ROUNDS: Final = 7
_ASKED_EVERY: Final = 20
_TYPES: Final = (
    fp.SensorType.SWITCH,
    fp.SensorType.SOUND_DB,
    fp.SensorType.LIGHT_ACTIVE,
    fp.SensorType.LOW_SPEED_9V,
)


def report() -> list[str]:
    """The measurement, as lines to print: processor time, which what else runs does not count in."""
    bare_ms = _second_ms(_moving().engine.step)
    motors_ms = _second_ms(_moving().body.step)
    arena = _moving()
    firmware = _sensing(arena)
    questions = [fp.encode_request(fp.GetInputValues(port)) for port in range(len(_TYPES) - 1)]
    sonar = arena.body.sensors[3]

    def whole() -> None:
        firmware.tick()
        if firmware.ticks % _ASKED_EVERY == 0:  # a program asks for all four readings fifty times a second
            for question in questions:
                firmware.receive(Transport.USB, question)
                firmware.transmit(Transport.USB)
            sonar.i2c_write(bytes((2, 0x42)), arena.time_s)
            sonar.i2c_read(1, arena.time_s)

    whole_ms = _second_ms(whole)
    return [
        f"world: 1 s costs {whole_ms:.0f} ms of one core, {1e3 / whole_ms:.1f} times real time (aim {AIM:g}), with "
        "firmware, two motors, four sensors read 50 times a second",
        f"of that PyBullet's steps alone {bare_ms:.0f} ms, motors and the seam to them {motors_ms - bare_ms:.0f} ms, "
        f"firmware and sensors {whole_ms - motors_ms:.0f} ms",
    ]


def _moving() -> Arena:
    arena = open_arena(load_setting("pen"))
    for port, power in ((1, 20), (2, 30)):
        arena.body.set_motor(port, power, brake=True)
    for _ in range(_TICKS):
        arena.body.step()
    return arena


def _sensing(arena: Arena) -> Firmware:
    firmware = Firmware(arena.body, arena.setting.world.identity())
    requests: list[fp.Command[fp.NoData]] = [
        fp.SetInputMode(port, kind, fp.SensorMode.RAW) for port, kind in enumerate(_TYPES)
    ]
    requests += [fp.SetOutputState(port, 25, 0x03, 0, 0, 0x20, 0) for port in (1, 2)]
    for request in requests:
        firmware.receive(Transport.USB, fp.encode_request(request))
        for _ in range(20):
            firmware.tick()
    return firmware


def _second_ms(tick: Callable[[], None]) -> float:
    """The least of some rounds, ms of processor time: what else runs takes cache and memory from the others."""
    costs = []
    for _ in range(_ROUNDS):
        start_s = time.process_time()
        for _ in range(_TICKS):
            tick()
        costs.append((time.process_time() - start_s) * 1e3)
    return min(costs)


if __name__ == "__main__":
    print("\n".join(report()))
