"""The brick itself: who it is, battery, sleep, firmware download mode and raw buffers."""

from __future__ import annotations

from typing import NamedTuple, final

from firmware_protocol import (
    Boot,
    GetBatteryLevel,
    GetDeviceInfo,
    GetProperty,
    GetVersions,
    Poll,
    PollLength,
    PropertyId,
    SetBrickName,
    SetProperty,
)
from firmware_protocol.bluetooth import address_text
from nxt_twin.brick.exchange import Exchange
from nxt_twin.brick.question import compiled_question
from nxt_twin.brick.stamped import Stamped


class Versions(NamedTuple):
    """The versions that the brick reports, such as firmware ``1.29`` and protocol ``1.124``."""

    protocol: str
    firmware: str


class DeviceInfo(NamedTuple):
    """Who the brick is.

    Attributes:
        name: its name, at most 15 characters.
        bluetooth_address: such as ``00:16:53:01:02:03``.
        link_quality: of each of the four Bluetooth connections, 0…255.
        free_flash_bytes: room for files.
    """

    name: str
    bluetooth_address: str
    link_quality: tuple[int, ...]
    free_flash_bytes: int


@final
class Device:
    """The brick as a whole; every method raises what `Exchange.put` does."""

    def __init__(self, exchange: Exchange) -> None:
        self._exchange = exchange
        self._battery = compiled_question(GetBatteryLevel(), lambda voltage_mv: float(voltage_mv) / 1000)

    def versions(self) -> Stamped[Versions]:
        """The versions of protocol and firmware."""
        reply = self._exchange.ask(GetVersions())
        versions = reply.value
        return reply.having(
            Versions(
                protocol=f"{versions.protocol_major}.{versions.protocol_minor:02}",
                firmware=f"{versions.firmware_major}.{versions.firmware_minor:02}",
            )
        )

    def info(self) -> Stamped[DeviceInfo]:
        """Name, Bluetooth address, link qualities and free flash memory."""
        reply = self._exchange.ask(GetDeviceInfo())
        info = reply.value
        return reply.having(
            DeviceInfo(info.name, address_text(info.address), tuple(info.link_quality), info.free_flash)
        )

    def battery_v(self) -> Stamped[float]:
        """The battery voltage, V; measured anew every 167 ms, in steps of 13.848 mV."""
        return self._exchange.put(self._battery)

    def set_name(self, name: str) -> Stamped[None]:
        """Name the brick in up to 15 characters. Over Bluetooth, the next second's requests may be lost."""
        return self._exchange.ask(SetBrickName(name)).having(None)

    def keep_awake(self) -> Stamped[float]:
        """Put off the brick's falling asleep, which requests do by themselves when it is due.

        Returns:
            The sleep timeout, s; 0 for never.
        """
        return self._exchange.keep_awake()

    def sleep_timeout_s(self) -> Stamped[float]:
        """The time without use after which the brick switches itself off, s; 0 for never."""
        reply = self._exchange.ask(GetProperty(PropertyId.SLEEP_TIMEOUT))
        return reply.having(reply.value.value / 1000)

    def set_sleep_timeout_s(self, timeout_s: float) -> Stamped[None]:
        """Set the sleep timeout; the brick keeps whole minutes, 0 for never."""
        return self._exchange.ask(SetProperty(PropertyId.SLEEP_TIMEOUT, round(timeout_s * 1000))).having(None)

    def volume(self) -> Stamped[int]:
        """The loudspeaker's volume, 0…4."""
        reply = self._exchange.ask(GetProperty(PropertyId.VOLUME))
        return reply.having(reply.value.value)

    def set_volume(self, volume: int) -> Stamped[None]:
        """Set the loudspeaker's volume, 0…4."""
        return self._exchange.ask(SetProperty(PropertyId.VOLUME, volume)).having(None)

    def boot(self) -> Stamped[None]:
        """Put the brick into firmware download mode, over USB only: afterwards it is another device."""
        return self._exchange.ask(Boot()).having(None)

    def poll_length(self, buffer: int) -> Stamped[int]:
        """How many bytes wait in a raw buffer (`PollBuffer`)."""
        reply = self._exchange.ask(PollLength(buffer))
        return reply.having(reply.value.available)

    def poll(self, buffer: int, length: int) -> Stamped[bytes]:
        """Take bytes out of a raw buffer; more than 57 over USB or 121 over Bluetooth is refused."""
        reply = self._exchange.ask(Poll(buffer, length))
        return reply.having(reply.value.received)
