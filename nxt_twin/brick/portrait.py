"""All that a brick tells of itself without moving anything or changing a setting."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from firmware_protocol import InputPort, OutputPort, RunState
from nxt_twin.brick.brick import Brick


@final
@dataclass(frozen=True)
class MotorPortrait:
    """A motor port.

    Attributes:
        port: ``A``, ``B`` or ``C``.
        tacho_deg: its count.
        running: whether it is driven.
        power_pct: the power that is set.
    """

    port: str
    tacho_deg: int
    running: bool
    power_pct: int


@final
@dataclass(frozen=True)
class SensorPortrait:
    """A sensor port.

    Attributes:
        port: 1 to 4.
        sensor_type: what it is set up for, such as ``SWITCH``; the brick cannot tell what is plugged in.
        raw: the converter's reading, 0…1023.
    """

    port: int
    sensor_type: str
    raw: int


@final
@dataclass(frozen=True)
class Portrait:
    """A brick.

    Attributes:
        link: how it was reached.
        name: its name.
        bluetooth_address: its address.
        firmware: the firmware's version.
        protocol: the protocol's version.
        battery_v: the battery voltage, V.
        free_flash_bytes: room for files.
        sleep_timeout_s: after how long without use it switches itself off, s; 0 for never.
        program: the running program's file name; None where none runs.
        round_trip_s: how long the last request and its reply took, s.
        motors: the motor ports.
        sensors: the sensor ports.
    """

    link: str
    name: str
    bluetooth_address: str
    firmware: str
    protocol: str
    battery_v: float
    free_flash_bytes: int
    sleep_timeout_s: float
    program: str | None
    round_trip_s: float
    motors: tuple[MotorPortrait, ...]
    sensors: tuple[SensorPortrait, ...]


def driven(brick: Brick) -> dict[str, int]:
    """The power (%) of each driven motor, by its port ``A``, ``B`` or ``C``; errors as with its commands."""
    motors = [_motor(brick, port) for port in OutputPort if port is not OutputPort.ALL]
    return {motor.port: motor.power_pct for motor in motors if motor.running and motor.power_pct}


def portray(brick: Brick) -> Portrait:
    """Ask a brick for all of it; raises what its commands do."""
    versions = brick.device.versions().value
    info = brick.device.info().value
    battery = brick.device.battery_v()
    return Portrait(
        link=brick.describe(),
        name=info.name,
        bluetooth_address=info.bluetooth_address,
        firmware=versions.firmware,
        protocol=versions.protocol,
        battery_v=battery.value,
        free_flash_bytes=info.free_flash_bytes,
        sleep_timeout_s=brick.device.sleep_timeout_s().value,
        program=brick.programs.current().value,
        round_trip_s=battery.received_s - battery.sent_s,
        motors=tuple(_motor(brick, port) for port in OutputPort if port is not OutputPort.ALL),
        sensors=tuple(_sensor(brick, port) for port in InputPort),
    )


def _motor(brick: Brick, port: OutputPort) -> MotorPortrait:
    state = brick.motors.read(port).value
    running = state.run_state != RunState.IDLE
    return MotorPortrait(port.name, state.tacho_deg, running=running, power_pct=state.power_pct)


def _sensor(brick: Brick, port: InputPort) -> SensorPortrait:
    reading = brick.sensors.read(port).value
    return SensorPortrait(
        port + 1, getattr(reading.sensor_type, "name", str(reading.sensor_type)), reading.raw
    )
