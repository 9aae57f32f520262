"""The facts about a machine from which the doctor draws conclusions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True)
class RuleFile:
    """A rule file of udev.

    Attributes:
        path: where it is; its number orders it among the others.
        text: what it says.
    """

    path: str
    text: str


@final
@dataclass(frozen=True)
class SerialPortFacts:
    """A serial port that may lead to a brick.

    Attributes:
        device: its name.
        group: the group that owns it; empty where there are none.
        accessible: whether this user may read and write it.
        users: the programs that have it open, as far as this user may see, such as ``python3 (4711)``.
    """

    device: str
    group: str = ""
    accessible: bool = True
    users: tuple[str, ...] = ()


@final
@dataclass(frozen=True)
class UsbFacts:
    """A brick on USB.

    Attributes:
        place: where it is plugged in.
        obstacle: what keeps it from being used; empty where nothing is known to.
        mend: what to do about that.
    """

    place: str
    obstacle: str = ""
    mend: str = ""


@final
@dataclass(frozen=True)
class PackageFacts:
    """An installed or missing package that this program depends on.

    Attributes:
        name: the package.
        wanted: the versions that will do, such as ``>=1.3``.
        installed: its version; empty if it is missing.
        fits: whether that version will do.
    """

    name: str
    wanted: str
    installed: str
    fits: bool


@final
@dataclass(frozen=True)
class MachineFacts:
    """All that is asked of a machine.

    Attributes:
        system: ``Linux``, ``Darwin`` or ``Windows``.
        python: Python's version.
        is_root: whether this user may do everything.
        groups: the user's groups.
        udev_rules: udev's rule files that name an NXT.
        libusb: the error that loading libusb gives; empty if it loads.
        usb: the bricks on USB.
        usb_error: why USB cannot be searched; empty if it can.
        bluetooth_sockets: what keeps this Python from Bluetooth sockets; empty if nothing does.
        bluetooth_adapters: the radio adapters' names.
        bluetooth_tools: which of ``bluetoothctl`` and ``rfcomm`` are there.
        serial_ports: the serial ports.
        packages: the packages that this program depends on.
    """

    system: str
    python: tuple[int, int, int]
    is_root: bool = False
    groups: frozenset[str] = frozenset()
    udev_rules: tuple[RuleFile, ...] = ()
    libusb: str = ""
    usb: tuple[UsbFacts, ...] = ()
    usb_error: str = ""
    bluetooth_sockets: str = ""
    bluetooth_adapters: tuple[str, ...] = ()
    bluetooth_tools: frozenset[str] = frozenset()
    serial_ports: tuple[SerialPortFacts, ...] = ()
    packages: tuple[PackageFacts, ...] = ()
