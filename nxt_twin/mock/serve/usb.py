"""The mock brick as a USB device: a backend for pyusb, so that pyusb's own code runs against it."""

from __future__ import annotations

import errno
from array import array
from collections.abc import Iterator, Sequence
from typing import Any, Final, NamedTuple, final

import usb.backend
import usb.core
import usb.util

from firmware_protocol import usb as nxt_usb
from nxt_twin.mock.firmware.channel import Transport
from nxt_twin.mock.firmware.firmware import Power
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.line import Line
from nxt_twin.mock.serve.profile import PROFILES, Profile

_SERIAL_INDEX: Final = 1
_LANGUAGE_ENGLISH_US: Final = 0x0409
_STRING_DESCRIPTOR: Final = 3
_GET_DESCRIPTOR: Final = 0x06
_FULL_SPEED: Final = 2


class DeviceDescriptor(NamedTuple):
    """The device descriptor's fields under pyusb's names, and where the device is plugged in."""

    bLength: int  # noqa: N815 - the standard's names
    bDescriptorType: int  # noqa: N815
    bcdUSB: int  # noqa: N815
    bDeviceClass: int  # noqa: N815
    bDeviceSubClass: int  # noqa: N815
    bDeviceProtocol: int  # noqa: N815
    bMaxPacketSize0: int  # noqa: N815
    idVendor: int  # noqa: N815
    idProduct: int  # noqa: N815
    bcdDevice: int  # noqa: N815
    iManufacturer: int  # noqa: N815
    iProduct: int  # noqa: N815
    iSerialNumber: int  # noqa: N815
    bNumConfigurations: int  # noqa: N815
    address: int
    bus: int
    port_number: int
    port_numbers: tuple[int, ...]
    speed: int


class ConfigurationDescriptor(NamedTuple):
    """The one configuration."""

    bLength: int = 9  # noqa: N815
    bDescriptorType: int = 2  # noqa: N815
    wTotalLength: int = 32  # noqa: N815
    bNumInterfaces: int = 1  # noqa: N815
    bConfigurationValue: int = 1  # noqa: N815
    iConfiguration: int = 0  # noqa: N815
    bmAttributes: int = 0xC0  # noqa: N815
    bMaxPower: int = 0  # noqa: N815
    extra_descriptors: tuple[int, ...] = ()


class InterfaceDescriptor(NamedTuple):
    """The one interface, vendor specific."""

    bLength: int = 9  # noqa: N815
    bDescriptorType: int = 4  # noqa: N815
    bInterfaceNumber: int = 0  # noqa: N815
    bAlternateSetting: int = 0  # noqa: N815
    bNumEndpoints: int = 2  # noqa: N815
    bInterfaceClass: int = nxt_usb.INTERFACE_CLASS[0]  # noqa: N815
    bInterfaceSubClass: int = nxt_usb.INTERFACE_CLASS[1]  # noqa: N815
    bInterfaceProtocol: int = nxt_usb.INTERFACE_CLASS[2]  # noqa: N815
    iInterface: int = 0  # noqa: N815
    extra_descriptors: tuple[int, ...] = ()


class EndpointDescriptor(NamedTuple):
    """A bulk endpoint."""

    bEndpointAddress: int  # noqa: N815
    bLength: int = 7  # noqa: N815
    bDescriptorType: int = 5  # noqa: N815
    bmAttributes: int = usb.util.ENDPOINT_TYPE_BULK  # noqa: N815
    wMaxPacketSize: int = nxt_usb.PACKET_SIZE  # noqa: N815
    bInterval: int = 0  # noqa: N815
    bRefresh: int = 0  # noqa: N815
    bSynchAddress: int = 0  # noqa: N815
    extra_descriptors: tuple[int, ...] = ()


_ENDPOINTS: Final = (
    EndpointDescriptor(nxt_usb.ENDPOINT_OUT),
    EndpointDescriptor(nxt_usb.ENDPOINT_IN),
)


@final
class ServedUsbDevice:
    """A mock brick in a USB socket.

    Args:
        host: the running brick.
        address: its number on the bus.
        profile: delays and faults.
        seed: of the jitter and the faults.
    """

    def __init__(
        self, host: Host, *, address: int = 1, profile: Profile = PROFILES["usb"], seed: int = 0
    ) -> None:
        self.host = host
        self.address = address
        self.plugged_in = True
        self.configuration = 0
        self.line: Line = host.connect(Transport.USB, profile, seed)
        host.take(self.line)

    @property
    def present(self) -> bool:
        """Whether a host sees it at all."""
        return self.plugged_in and self.host.firmware.power is not Power.OFF

    def unplug(self) -> None:
        """Pull the cable."""
        self.plugged_in = False
        self.configuration = 0
        self.line.hang_up()

    def plug_in(self) -> None:
        """Put the cable back."""
        self.plugged_in = True

    def descriptor(self) -> DeviceDescriptor:
        """The device's descriptor: a brick, or in firmware download mode Atmel's boot program."""
        booted = self.host.firmware.power is Power.DOWNLOAD
        return DeviceDescriptor(
            bLength=18,
            bDescriptorType=1,
            bcdUSB=0x0200,
            bDeviceClass=0,
            bDeviceSubClass=0,
            bDeviceProtocol=0,
            bMaxPacketSize0=nxt_usb.CONTROL_PACKET_SIZE,
            idVendor=nxt_usb.BOOT_VENDOR_ID if booted else nxt_usb.VENDOR_ID,
            idProduct=nxt_usb.BOOT_PRODUCT_ID if booted else nxt_usb.PRODUCT_ID,
            bcdDevice=0,
            iManufacturer=0,
            iProduct=0,
            iSerialNumber=0 if booted else _SERIAL_INDEX,
            bNumConfigurations=1,
            address=self.address,
            bus=1,
            port_number=self.address,
            port_numbers=(self.address,),
            speed=_FULL_SPEED,
        )

    def serial_number(self) -> str:
        """Twelve hexadecimal digits: the Bluetooth address."""
        return self.host.firmware.radio.address[:6].hex().upper()


@final
class MockUsbBackend(usb.backend.IBackend):  # type: ignore[misc]  # pyusb is untyped
    """A USB bus with mock bricks on it; pass it to ``usb.core.find(backend=…)``.

    Args:
        devices: what is plugged in; they may be unplugged and plugged in again.
    """

    def __init__(self, devices: Sequence[ServedUsbDevice]) -> None:
        self._devices = devices

    def enumerate_devices(self) -> Iterator[ServedUsbDevice]:
        """All devices that are present."""
        return iter([device for device in self._devices if device.present])

    def get_device_descriptor(self, dev: ServedUsbDevice) -> DeviceDescriptor:
        """The device descriptor."""
        return dev.descriptor()

    def get_configuration_descriptor(self, dev: ServedUsbDevice, config: int) -> ConfigurationDescriptor:
        """The only configuration's descriptor."""
        del dev
        _only(config)
        return ConfigurationDescriptor()

    def get_interface_descriptor(
        self, dev: ServedUsbDevice, intf: int, alt: int, config: int
    ) -> InterfaceDescriptor:
        """The only interface's descriptor."""
        del dev
        _only(intf, alt, config)
        return InterfaceDescriptor()

    def get_endpoint_descriptor(
        self, dev: ServedUsbDevice, ep: int, intf: int, alt: int, config: int
    ) -> EndpointDescriptor:
        """One of the two endpoints' descriptors."""
        del dev
        _only(intf, alt, config)
        return _ENDPOINTS[ep]

    def open_device(self, dev: ServedUsbDevice) -> ServedUsbDevice:
        """A handle."""
        _check_present(dev)
        return dev

    def close_device(self, dev_handle: ServedUsbDevice) -> None:
        """Nothing is held."""

    def set_configuration(self, dev_handle: ServedUsbDevice, config_value: int) -> None:
        """Configure the device."""
        _check_present(dev_handle)
        dev_handle.configuration = config_value

    def get_configuration(self, dev_handle: ServedUsbDevice) -> int:
        """The configuration in force; 0 before the first one is set."""
        _check_present(dev_handle)
        return dev_handle.configuration

    def set_interface_altsetting(self, dev_handle: ServedUsbDevice, intf: int, altsetting: int) -> None:
        """There is only one setting."""
        _check_present(dev_handle)
        _only(intf, altsetting)

    def claim_interface(self, dev_handle: ServedUsbDevice, intf: int) -> None:
        """Nobody else wants it."""
        _check_present(dev_handle)
        _only(intf)

    def release_interface(self, dev_handle: ServedUsbDevice, intf: int) -> None:
        """Nobody else wants it."""
        del dev_handle
        _only(intf)

    def bulk_write(
        self, dev_handle: ServedUsbDevice, ep: int, intf: int, data: array[int], timeout: int
    ) -> int:
        """Send bytes, in packets of at most 64."""
        del intf, timeout
        _check_present(dev_handle)
        _check_endpoint(ep, nxt_usb.ENDPOINT_OUT)
        dev_handle.host.catch_up()
        raw = data.tobytes()
        for at in range(0, len(raw), nxt_usb.PACKET_SIZE):
            dev_handle.line.write(raw[at : at + nxt_usb.PACKET_SIZE])
        return len(raw)

    def bulk_read(
        self, dev_handle: ServedUsbDevice, ep: int, intf: int, buff: array[int], timeout: int
    ) -> int:
        """Receive a packet; the timeout is in ms, 0 for ever."""
        del intf
        _check_endpoint(ep, nxt_usb.ENDPOINT_IN)
        host = dev_handle.host
        host.catch_up()
        deadline_s = host.clock.now_s() + timeout / 1000.0 if timeout else float("inf")
        while True:
            packet = dev_handle.line.read()
            if packet is not None:
                kept = packet[: len(buff)]
                buff[: len(kept)] = array("B", kept)
                return len(kept)
            _check_present(dev_handle)
            if host.clock.now_s() >= deadline_s:
                raise usb.core.USBTimeoutError("Operation timed out", -7, errno.ETIMEDOUT)
            host.wait(deadline_s)

    def ctrl_transfer(
        self,
        dev_handle: ServedUsbDevice,
        bmRequestType: int,  # noqa: N803 - the standard's names
        bRequest: int,  # noqa: N803
        wValue: int,  # noqa: N803
        wIndex: int,  # noqa: N803
        data: array[int],
        timeout: int,
    ) -> int:
        """Answer requests for string descriptors, of which the serial number is the only one."""
        del bmRequestType, wIndex, timeout
        _check_present(dev_handle)
        if bRequest != _GET_DESCRIPTOR or wValue >> 8 != _STRING_DESCRIPTOR:
            raise _error("Pipe error", errno.EPIPE)
        index = wValue & 0xFF
        if index == 0:
            body = _LANGUAGE_ENGLISH_US.to_bytes(2, "little")
        elif index == dev_handle.descriptor().iSerialNumber:
            body = dev_handle.serial_number().encode("utf-16-le")
        else:
            raise _error("Pipe error", errno.EPIPE)
        descriptor = bytes((2 + len(body), _STRING_DESCRIPTOR)) + body
        kept = descriptor[: len(data)]
        data[: len(kept)] = array("B", kept)
        return len(kept)

    def clear_halt(self, dev_handle: ServedUsbDevice, ep: int) -> None:
        """No endpoint ever halts."""
        del ep
        _check_present(dev_handle)

    def reset_device(self, dev_handle: ServedUsbDevice) -> None:
        """Reset the bus: what is on its way is lost, the firmware runs on."""
        _check_present(dev_handle)
        dev_handle.line.reset()
        dev_handle.configuration = 0

    def is_kernel_driver_active(self, dev_handle: ServedUsbDevice, intf: int) -> bool:
        """No kernel has a driver for bricks."""
        del dev_handle, intf
        return False


def _only(*numbers: int) -> None:
    """Refuse every configuration, interface and setting but the first; all count from 0."""
    if any(numbers):
        raise IndexError("the brick has one configuration, one interface and one setting")


def _check_endpoint(given: int, wanted: int) -> None:
    if given != wanted:
        raise _error("Entity not found", errno.ENOENT)


def _check_present(device: ServedUsbDevice) -> None:
    if not device.present:
        raise _error("No such device (it may have been disconnected)", errno.ENODEV)


def _error(text: str, number: int) -> Any:  # noqa: ANN401 - pyusb is untyped
    return usb.core.USBError(text, None, number)
