"""A pyusb backend with bricks in it, so that pyusb's own code runs; faults are set by the test."""

# ruff: noqa: ARG002, N803 - the methods are pyusb's

from __future__ import annotations

import array
import errno
from collections import deque
from types import SimpleNamespace

import usb.backend
import usb.core

VERSIONS_REPLY = bytes.fromhex("0288007c011d01")


class FakeUsbBrick:
    """One device.

    Args:
        serial: its serial number.
        product: its product string; empty for LEGO's firmware.
        vendor: vendor and product number.
    """

    def __init__(self, serial: str = "001653010203", product: str = "", vendor=(0x0694, 0x0002)) -> None:
        self.serial, self.product, self.vendor = serial, product, vendor
        self.stale: deque[bytes] = deque()
        self.open_error = 0
        self.claim_error = 0
        self.halted = False
        self.silent_until_reset = False
        self.unplugged = False
        self.calls: list[str] = []
        self.claimed = False

    def answer(self, telegram: bytes) -> bytes:
        return VERSIONS_REPLY if telegram[1] == 0x88 else bytes((2, telegram[1], 0))


class FakeUsbBackend(usb.backend.IBackend):
    """The bricks that are plugged in."""

    def __init__(self, *bricks: FakeUsbBrick) -> None:
        self.bricks = bricks

    def enumerate_devices(self):
        return iter(self.bricks)

    def get_device_descriptor(self, dev):
        return SimpleNamespace(
            bLength=18, bDescriptorType=1, bcdUSB=0x200, bDeviceClass=0, bDeviceSubClass=0, bDeviceProtocol=0,
            bMaxPacketSize0=8, idVendor=dev.vendor[0], idProduct=dev.vendor[1], bcdDevice=0, iManufacturer=0,
            iProduct=2 if dev.product else 0, iSerialNumber=1, bNumConfigurations=1, address=5, bus=1,
            port_number=1, port_numbers=(1,), speed=2,
        )  # fmt: skip

    def get_configuration_descriptor(self, dev, config):
        return SimpleNamespace(
            bLength=9, bDescriptorType=2, wTotalLength=32, bNumInterfaces=1, bConfigurationValue=1,
            iConfiguration=0, bmAttributes=0xC0, bMaxPower=0, extra_descriptors=[],
        )  # fmt: skip

    def get_interface_descriptor(self, dev, intf, alt, config):
        if intf or alt:
            raise IndexError
        return SimpleNamespace(
            bLength=9, bDescriptorType=4, bInterfaceNumber=0, bAlternateSetting=0, bNumEndpoints=2,
            bInterfaceClass=255, bInterfaceSubClass=255, bInterfaceProtocol=255, iInterface=0,
            extra_descriptors=[],
        )  # fmt: skip

    def get_endpoint_descriptor(self, dev, ep, intf, alt, config):
        return SimpleNamespace(
            bLength=7, bDescriptorType=5, bEndpointAddress=(0x01, 0x82)[ep], bmAttributes=2,
            wMaxPacketSize=64, bInterval=0, bRefresh=0, bSynchAddress=0, extra_descriptors=[],
        )  # fmt: skip

    def open_device(self, dev):
        if dev.open_error:
            raise usb.core.USBError("open", None, dev.open_error)
        return dev

    def close_device(self, dev_handle):
        pass

    def get_configuration(self, dev_handle):
        return 1

    def set_configuration(self, dev_handle, config_value):
        dev_handle.calls.append("configure")

    def claim_interface(self, dev_handle, intf):
        if dev_handle.claim_error:
            raise usb.core.USBError("claim", None, dev_handle.claim_error)
        dev_handle.claimed = True

    def release_interface(self, dev_handle, intf):
        dev_handle.claimed = False

    def ctrl_transfer(self, dev_handle, bmRequestType, bRequest, wValue, wIndex, data, timeout):
        index = wValue & 0xFF
        text = ("", dev_handle.serial, dev_handle.product)[index]
        raw = b"\x04\x03\x09\x04" if index == 0 else bytes((2 + 2 * len(text), 3)) + text.encode("utf-16-le")
        raw = raw[: len(data)]
        data[: len(raw)] = array.array("B", raw)
        return len(raw)

    def bulk_write(self, dev_handle, ep, intf, data, timeout):
        self._check(dev_handle)
        if not dev_handle.silent_until_reset:
            dev_handle.stale.append(dev_handle.answer(bytes(data)))
        return len(data)

    def bulk_read(self, dev_handle, ep, intf, buff, timeout):
        self._check(dev_handle)
        if dev_handle.halted:
            raise usb.core.USBError("halted", None, errno.EPIPE)
        if not dev_handle.stale:
            raise usb.core.USBTimeoutError("timeout", None, errno.ETIMEDOUT)
        packet = array.array("B", dev_handle.stale.popleft())
        buff[: len(packet)] = packet
        return len(packet)

    def clear_halt(self, dev_handle, ep):
        dev_handle.calls.append("clear halt")
        dev_handle.halted = False

    def reset_device(self, dev_handle):
        dev_handle.calls.append("reset")
        dev_handle.silent_until_reset = False

    def is_kernel_driver_active(self, dev_handle, intf):
        return False

    @staticmethod
    def _check(brick: FakeUsbBrick) -> None:
        if brick.unplugged:
            raise usb.core.USBError("gone", None, errno.ENODEV)
