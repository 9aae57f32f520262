"""Cost of a second of a mock brick's time, with three loaded motors under speed regulation."""

from __future__ import annotations

import time
from typing import Final

import firmware_protocol as fp
from nxt_twin.mock.body.world import World
from nxt_twin.mock.firmware.channel import Transport
from nxt_twin.mock.firmware.firmware import Firmware

LIMIT_MS: Final = 20.0
_SECOND_TICKS: Final = 1000
_ROUNDS: Final = 10
_LOADED_PLANT: Final = {
    "kind": "dc_motor",
    "resistance_ohm": 7.6,
    "inductance_h": 4.88e-3,
    "torque_constant_nm_per_a": 0.4908,
    "back_emf_v_s_per_rad": 0.4908,
    "coulomb_friction_nm": 8.45e-3,
    "viscous_friction_nm_s_per_rad": 1.92e-3,
    "inertia_kg_m2": 1.2e-3,
    "effects": {"constant_load": {"load_torque_nm": -0.03}},
}


def report() -> list[str]:
    """The measurement, as lines to print."""
    firmware = _driving()
    costs_ms = sorted(_second_ms(firmware) for _ in range(_ROUNDS))
    return [
        f"mock: 1 s of its time costs {costs_ms[0]:.1f} ms at best, {costs_ms[_ROUNDS // 2]:.1f} ms in the "
        f"middle of {_ROUNDS} (three loaded motors, three analogue sensors; limit {LIMIT_MS:g} ms)"
    ]


def _driving() -> Firmware:
    world = World(motors=dict.fromkeys(("a", "b", "c"), _LOADED_PLANT))
    firmware = Firmware(world.body(), world.identity())
    sensor_types = (fp.SensorType.SWITCH, fp.SensorType.SOUND_DB, fp.SensorType.LIGHT_ACTIVE)
    requests: list[fp.Command[fp.NoData]] = [
        fp.SetInputMode(port, sensor_type, fp.SensorMode.RAW) for port, sensor_type in enumerate(sensor_types)
    ]
    requests += [fp.SetOutputState(port, 60, 0x07, 1, 0, 0x20, 0) for port in range(3)]
    for request in requests:
        firmware.receive(Transport.USB, fp.encode_request(request))
    for _ in range(_SECOND_TICKS):
        firmware.tick()
    return firmware


def _second_ms(firmware: Firmware) -> float:
    start_s = time.perf_counter()
    for _ in range(_SECOND_TICKS):
        firmware.tick()
    return (time.perf_counter() - start_s) * 1e3


if __name__ == "__main__":
    print("\n".join(report()))
