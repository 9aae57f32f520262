"""``usb:`` and ``usb:SERIAL``: one telegram a packet, no framing.

A session that broke off may leave a reply unread or an endpoint halted. So opening asks for the versions,
which changes nothing, and mends what keeps the answer away: drain, then clear halt, then reset.
"""

from __future__ import annotations

import array
import errno
import os
from enum import StrEnum
from typing import Any, Final, final

import usb.core
import usb.util

from firmware_protocol import GetVersions, encode_request
from firmware_protocol.usb import ENDPOINT_IN, ENDPOINT_OUT, PACKET_SIZE
from nxt_twin.brick.clock import Clock
from nxt_twin.brick.errors import (
    GarbageError,
    LinkError,
    LinkLostError,
    LinkRefusedError,
    LinkTimeoutError,
    Refusal,
)
from nxt_twin.brick.links.usb_devices import (
    UsbBackend,
    UsbDevice,
    boot_mode_refusal,
    default_backend,
    find_booting,
    find_bricks,
    usb_refusal,
)
from nxt_twin.brick.question import question
from nxt_twin.brick.url import usb_serial

_WRITE_TIMEOUT_MS: Final = 2000
_DRAIN_S: Final = 0.02
_PROBE_S: Final = 0.5
_DRAIN_READS_MAX: Final = 64
_PROBE: Final = question(GetVersions())


class Recovery(StrEnum):
    """The measures that made a brick answer; each includes those before it."""

    NONE = "nothing"
    DRAIN = "drain"
    CLEAR_HALT = "clear halt"
    RESET = "reset"


@final
class UsbLink:
    """An open USB device.

    Args:
        device: pyusb's device, configured and claimed, which the link takes over.
        url: the URL that names exactly this brick.
    """

    def __init__(self, device: Any, url: str) -> None:  # noqa: ANN401 - pyusb has no types
        self._device = device
        self._write, self._read = device.write, device.read
        self._packet: array.array[int] = usb.util.create_buffer(PACKET_SIZE)
        self._url = url
        self._open = True
        self.recovery = Recovery.NONE

    def send(self, telegram: bytes) -> None:
        """Hand one telegram over; errors as with `Link`."""
        if not self._open:
            raise self._closed()
        try:
            self._write(ENDPOINT_OUT, telegram, _WRITE_TIMEOUT_MS)
        except usb.core.USBTimeoutError as error:
            raise LinkTimeoutError("takes no more telegrams", where=self._url) from error
        except usb.core.USBError as error:
            raise self._failure(error, ENDPOINT_OUT) from error

    def receive(self, timeout_s: float) -> bytes:
        """Wait for one telegram; errors as with `Link`."""
        if not self._open:
            raise self._closed()
        try:
            # At least 1 ms: libusb takes 0 for ever.
            size = self._read(ENDPOINT_IN, self._packet, max(1, round(timeout_s * 1000)))
        except usb.core.USBTimeoutError as error:
            raise LinkTimeoutError(f"nothing came within {timeout_s:g} s", where=self._url) from error
        except usb.core.USBError as error:
            raise self._failure(error, ENDPOINT_IN) from error
        return self._packet[:size].tobytes()

    def close(self) -> None:
        """Give the device back; closing again does nothing."""
        if self._open:
            self._open = False
            usb.util.dispose_resources(self._device)

    def describe(self) -> str:
        """The URL, and what it took to make the brick answer."""
        needed = f" (needed: {self.recovery})" if self.recovery is not Recovery.NONE else ""
        return f"{self._url}{needed}"

    def drain(self) -> int:
        """Take out what an earlier session left unread, and tell how many telegrams that were."""
        count = 0
        for _ in range(_DRAIN_READS_MAX):
            try:
                self.receive(_DRAIN_S)
                count += 1
            except GarbageError:
                continue
            except LinkTimeoutError:
                break
        return count

    def clear_halt(self) -> None:
        """Set both endpoints going again, and their toggle bits with them."""
        for endpoint in (ENDPOINT_OUT, ENDPOINT_IN):
            self._device.clear_halt(endpoint)

    def reset(self) -> None:
        """Reset the device and set it up anew."""
        self._device.reset()
        usb.util.dispose_resources(self._device)
        _claim(self._device)

    def answers(self) -> bool:
        """Whether the brick tells its versions."""
        try:
            self.send(encode_request(_PROBE.request))
            return self.receive(_PROBE_S).startswith(_PROBE.head)
        except (LinkTimeoutError, GarbageError):
            return False

    def _failure(self, error: usb.core.USBError, endpoint: int) -> LinkError:
        if error.errno == errno.EPIPE:
            self._device.clear_halt(endpoint)
            if self.recovery is not Recovery.RESET:
                self.recovery = Recovery.CLEAR_HALT
            return GarbageError("the endpoint was halted, and is cleared now", where=self._url)
        if error.errno == errno.EOVERFLOW:
            return GarbageError("a packet came that is longer than any telegram", where=self._url)
        return LinkLostError(
            f"the connection is lost: {error.strerror or error}",
            where=self._url,
            mend="plug the brick in and switch it on",
        )

    def _closed(self) -> LinkLostError:
        return LinkLostError("the link was closed", where=self._url)


def open_usb(
    address: str, clock: Clock, *, backend: UsbBackend = None, may_reset: bool = os.name != "nt"
) -> UsbLink:
    """Open a brick on USB, and make it answer.

    Args:
        address: its serial number (twelve digits, with or without colons), or empty for the only one.
        clock: not needed here; libusb has its own.
        backend: pyusb's backend; None for the libusb that comes along.
        may_reset: whether a reset may be tried; on Windows the device is lost with it.

    Raises:
        LinkUrlError: the address is not a serial number.
        LinkRefusedError: there is no such brick, or its `cause` is another.
    """
    del clock
    chosen = _choose(usb_serial(address), default_backend() if backend is None else backend)
    if chosen.obstacle:
        raise chosen.obstacle
    url = f"usb:{chosen.serial or address}"
    link = UsbLink(chosen.device, url)
    try:
        _claim(chosen.device)
        _make_answer(link, url, may_reset=may_reset)
    except (usb.core.USBError, NotImplementedError) as error:
        link.close()
        raise usb_refusal(url, error) from error
    except LinkError:
        link.close()
        raise
    return link


def _choose(serial: str, backend: UsbBackend) -> UsbDevice:
    where = f"usb:{serial}" if serial else "usb"
    found = find_bricks(backend)
    if not found and find_booting(backend):
        raise boot_mode_refusal(where)
    if not found:
        raise LinkRefusedError(
            "there is no brick on USB",
            cause=Refusal.NOT_FOUND,
            where=where,
            mend="plug it in and switch it on; nxt-twin doctor says more",
        )
    fitting = [device for device in found if serial in ("", device.serial)]
    if len(fitting) == 1:
        return fitting[0]
    if not fitting and any(device.obstacle for device in found):
        return next(device for device in found if device.obstacle)
    there = ", ".join(f"usb:{device.serial}" for device in found)
    what = "there are several bricks on USB" if fitting else "there is no such brick on USB"
    raise LinkRefusedError(what, cause=Refusal.NOT_FOUND, where=where, mend=f"choose one of {there}")


def _claim(device: Any) -> None:  # noqa: ANN401
    """Configure only where needed: setting a configuration that is set already disturbs other programs."""
    try:
        device.get_active_configuration()
    except usb.core.USBError as error:
        if error.errno in (errno.EACCES, errno.EPERM, errno.EBUSY, errno.ENODEV):
            raise
        device.set_configuration()
    usb.util.claim_interface(device, 0)


def _make_answer(link: UsbLink, url: str, *, may_reset: bool) -> None:
    if link.drain() and link.recovery is Recovery.NONE:
        link.recovery = Recovery.DRAIN
    if link.answers():
        return
    link.recovery = Recovery.CLEAR_HALT
    link.clear_halt()
    link.drain()
    if link.answers():
        return
    if may_reset:
        link.recovery = Recovery.RESET
        link.reset()
        link.drain()
        if link.answers():
            return
    raise LinkRefusedError(
        f"the brick is there but does not answer, in spite of {link.recovery}",
        cause=Refusal.UNREACHABLE,
        where=url,
        mend="switch it off and on; if its screen is dark and it clicks, it is in firmware download mode",
    )
