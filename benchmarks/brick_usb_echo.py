"""A device for pyusb that answers at once: what is above it, pyusb's own code included, is timed."""

# ruff: noqa: ANN401, ARG002, N803 - the methods are pyusb's, which has no types

from __future__ import annotations

import array
from types import SimpleNamespace
from typing import Any

import usb.backend
import usb.core

from benchmarks.brick_peers import reply_to

SERIAL = "001653010203"


class UsbEchoBackend(usb.backend.IBackend):  # type: ignore[misc] - pyusb has no types
    """One brick, plugged in, which nothing can go wrong with."""

    def __init__(self) -> None:
        self._reply = b""

    def enumerate_devices(self) -> Any:
        return iter((self,))

    def get_device_descriptor(self, dev: object) -> Any:
        return SimpleNamespace(
            bLength=18, bDescriptorType=1, bcdUSB=0x200, bDeviceClass=0, bDeviceSubClass=0, bDeviceProtocol=0,
            bMaxPacketSize0=8, idVendor=0x0694, idProduct=0x0002, bcdDevice=0, iManufacturer=0, iProduct=0,
            iSerialNumber=1, bNumConfigurations=1, address=5, bus=1, port_number=1, port_numbers=(1,), speed=2,
        )  # fmt: skip

    def get_configuration_descriptor(self, dev: object, config: int) -> Any:
        return SimpleNamespace(
            bLength=9, bDescriptorType=2, wTotalLength=32, bNumInterfaces=1, bConfigurationValue=1,
            iConfiguration=0, bmAttributes=0xC0, bMaxPower=0, extra_descriptors=[],
        )  # fmt: skip

    def get_interface_descriptor(self, dev: object, intf: int, alt: int, config: int) -> Any:
        if intf or alt:
            raise IndexError
        return SimpleNamespace(
            bLength=9, bDescriptorType=4, bInterfaceNumber=0, bAlternateSetting=0, bNumEndpoints=2,
            bInterfaceClass=255, bInterfaceSubClass=255, bInterfaceProtocol=255, iInterface=0,
            extra_descriptors=[],
        )  # fmt: skip

    def get_endpoint_descriptor(self, dev: object, ep: int, intf: int, alt: int, config: int) -> Any:
        return SimpleNamespace(
            bLength=7, bDescriptorType=5, bEndpointAddress=(0x01, 0x82)[ep], bmAttributes=2,
            wMaxPacketSize=64, bInterval=0, bRefresh=0, bSynchAddress=0, extra_descriptors=[],
        )  # fmt: skip

    def open_device(self, dev: object) -> object:
        return dev

    def close_device(self, dev_handle: object) -> None:
        pass

    def get_configuration(self, dev_handle: object) -> int:
        return 1

    def set_configuration(self, dev_handle: object, config_value: int) -> None:
        pass

    def claim_interface(self, dev_handle: object, intf: int) -> None:
        pass

    def release_interface(self, dev_handle: object, intf: int) -> None:
        pass

    def reset_device(self, dev_handle: object) -> None:
        pass

    def ctrl_transfer(
        self, dev_handle: object, bmRequestType: int, bRequest: int, wValue: int, wIndex: int,
        data: array.array[int], timeout: int,
    ) -> int:  # fmt: skip
        text = SERIAL.encode("utf-16-le")
        raw = bytes((2 + len(text), 3)) + text if wValue & 0xFF else b"\x04\x03\x09\x04"
        raw = raw[: len(data)]
        data[: len(raw)] = array.array("B", raw)
        return len(raw)

    def bulk_write(self, dev_handle: object, ep: int, intf: int, data: array.array[int], timeout: int) -> int:
        self._reply = reply_to(data.tobytes())
        return len(data)

    def bulk_read(self, dev_handle: object, ep: int, intf: int, buff: array.array[int], timeout: int) -> int:
        if not self._reply:
            raise usb.core.USBTimeoutError("nothing is there", None, 110)
        reply, self._reply = self._reply, b""
        buff[: len(reply)] = array.array("B", reply)
        return len(reply)
