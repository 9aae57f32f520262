"""The devices on USB that are, or could be, a brick; looking at them changes nothing."""

from __future__ import annotations

import errno
from collections.abc import Callable
from typing import Any, Final, NamedTuple

import libusb_package
import usb.core
import usb.util

from firmware_protocol.usb import BOOT_PRODUCT_ID, BOOT_VENDOR_ID, PRODUCT_ID, VENDOR_ID
from nxt_twin.brick.errors import LinkRefusedError, Refusal

UDEV_MEND: Final = "nxt-twin udev prints the rule that grants access, and where to put it"
WINDOWS_MEND: Final = "bind the WinUSB driver to it with Zadig, and remove LEGO's own driver"

UsbBackend = Any
"""A backend of pyusb, which has no types."""


class UsbDevice(NamedTuple):
    """A device with an NXT's vendor and product number, as far as it lets itself be read.

    Attributes:
        device: pyusb's device.
        place: where it is plugged in, such as ``bus 1 device 5``.
        serial: its serial number, which is the Bluetooth address; empty where it cannot be read.
        obstacle: what keeps it from being used; None where nothing is known to.
    """

    device: Any
    place: str
    serial: str
    obstacle: LinkRefusedError | None


def default_backend() -> UsbBackend:
    """The libusb that comes with the package `libusb-package`.

    Raises:
        LinkRefusedError: it cannot be loaded on this machine.
    """
    backend = libusb_package.get_libusb1_backend()
    if backend is None:
        raise LinkRefusedError(
            "libusb cannot be loaded",
            cause=Refusal.NO_DRIVER,
            where="usb",
            mend="pip install --force-reinstall libusb-package",
        )
    return backend


def find_bricks(backend: UsbBackend) -> tuple[UsbDevice, ...]:
    """All devices with an NXT's numbers, whatever firmware they run.

    Raises:
        LinkRefusedError: this machine has no USB.
    """
    found = _guarded(
        "usb",
        lambda: list(
            usb.core.find(find_all=True, idVendor=VENDOR_ID, idProduct=PRODUCT_ID, backend=backend) or ()
        ),
    )
    return tuple(_examine(device) for device in found)


def find_booting(backend: UsbBackend) -> tuple[str, ...]:
    """The places of bricks in firmware download mode, which are other devices (Atmel's SAM-BA)."""
    found = _guarded(
        "usb",
        lambda: list(
            usb.core.find(find_all=True, idVendor=BOOT_VENDOR_ID, idProduct=BOOT_PRODUCT_ID, backend=backend)
            or ()
        ),
    )
    return tuple(_place(device) for device in found)


def boot_mode_refusal(where: str) -> LinkRefusedError:
    """A brick in firmware download mode."""
    return LinkRefusedError(
        "a brick is in firmware download mode (SAM-BA, 03eb:6124) and speaks another language",
        cause=Refusal.BOOT_MODE,
        where=where,
        mend="load a firmware onto it, or take the battery out and in again",
    )


def usb_refusal(where: str, error: Exception) -> LinkRefusedError:
    """The error for a user that a failure of libusb means.

    Args:
        where: the URL or place of the device.
        error: what pyusb raised.
    """
    number = getattr(error, "errno", None)
    if number in (errno.EACCES, errno.EPERM):
        return LinkRefusedError(
            "may not be opened by this user", cause=Refusal.NO_PERMISSION, where=where, mend=UDEV_MEND
        )
    if number == errno.EBUSY:
        return LinkRefusedError(
            "another program or driver holds it",
            cause=Refusal.BUSY,
            where=where,
            mend="close LEGO software, other Python sessions and virtual machines that use it",
        )
    if isinstance(error, NotImplementedError) or number in (errno.ENOSYS, errno.EOPNOTSUPP):
        return LinkRefusedError(
            "has no driver that libusb can use", cause=Refusal.NO_DRIVER, where=where, mend=WINDOWS_MEND
        )
    if number in (errno.ENODEV, errno.ENOENT):
        return LinkRefusedError(
            "was unplugged or switched off", cause=Refusal.NOT_FOUND, where=where, mend="plug it in again"
        )
    return LinkRefusedError(f"cannot be used: {error}", cause=Refusal.UNREACHABLE, where=where)


def _examine(device: Any) -> UsbDevice:  # noqa: ANN401
    place = _place(device)
    try:
        serial = _string(device, device.iSerialNumber)
        product = _string(device, device.iProduct)
    except (usb.core.USBError, NotImplementedError, ValueError) as error:
        # pyusb raises ValueError where a device without access tells no languages.
        refused = usb_refusal(place, _without_languages(error))
        return UsbDevice(device, place, "", refused)
    finally:
        usb.util.dispose_resources(device)
    return UsbDevice(device, place, serial.upper(), _other_firmware(place, product))


def _without_languages(error: Exception) -> Exception:
    return PermissionError(errno.EACCES, str(error)) if isinstance(error, ValueError) else error


def _other_firmware(place: str, product: str) -> LinkRefusedError | None:
    """LEGO's firmware has no product string; others name themselves."""
    if not product:
        return None
    return LinkRefusedError(
        f"this brick runs other firmware ({product})",
        cause=Refusal.OTHER_FIRMWARE,
        where=place,
        mend="load LEGO's firmware 1.28 or later onto it",
    )


def _string(device: Any, index: int) -> str:  # noqa: ANN401
    return str(usb.util.get_string(device, index) or "").rstrip("\0") if index else ""


def _place(device: Any) -> str:  # noqa: ANN401
    return f"USB bus {device.bus} device {device.address}"


def _guarded(where: str, look: Callable[[], list[Any]]) -> list[Any]:
    try:
        return look()
    except (usb.core.USBError, usb.core.NoBackendError, NotImplementedError) as error:
        raise usb_refusal(where, error) from error
