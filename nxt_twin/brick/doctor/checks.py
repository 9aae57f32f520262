"""The doctor's conclusions: from the facts about a machine to what closes which way to a brick."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Final

from nxt_twin.brick.doctor.facts import MachineFacts, PackageFacts, SerialPortFacts, UsbFacts
from nxt_twin.brick.doctor.finding import Finding, Severity
from nxt_twin.brick.doctor.udev import RULE_PATH, comes_too_late, install_commands, rule_grants

_PYTHON_MIN: Final = (3, 11)


def examine(facts: MachineFacts) -> tuple[Finding, ...]:
    """Everything there is to say about a machine, in the order from Python outwards."""
    return tuple(finding for check in _CHECKS for finding in check(facts))


def check_python(facts: MachineFacts) -> Iterable[Finding]:
    """Is this Python new enough?"""
    version = ".".join(map(str, facts.python))
    if facts.python >= _PYTHON_MIN:
        yield Finding("python", Severity.OK, f"Python {version}")
    else:
        yield Finding(
            "python",
            Severity.FAIL,
            f"Python {version}",
            "nxt-twin needs Python 3.11 or later",
            "python3.11 -m venv .venv && .venv/bin/pip install nxt-twin",
        )


def check_packages(facts: MachineFacts) -> Iterable[Finding]:
    """Do the packages fit together?"""
    for package in facts.packages:
        yield _package_finding(package)


def check_libusb(facts: MachineFacts) -> Iterable[Finding]:
    """Can libusb be loaded?"""
    if not facts.libusb:
        yield Finding("libusb", Severity.OK, "libusb can be loaded")
    else:
        yield Finding(
            "libusb",
            Severity.FAIL,
            f"libusb cannot be loaded: {facts.libusb}",
            "no brick can be reached over USB",
            "pip install --force-reinstall libusb-package",
        )


def check_udev(facts: MachineFacts) -> Iterable[Finding]:
    """Does a udev rule let this user open a brick?"""
    if facts.system != "Linux":
        return
    granting = [rule.path for rule in facts.udev_rules if rule_grants(rule.path, rule.text)]
    if granting:
        yield Finding("udev", Severity.OK, f"{granting[0]} grants access to bricks on USB")
        return
    late = [rule.path for rule in facts.udev_rules if comes_too_late(rule.path)]
    what = f"{late[0]} comes too late to grant access" if late else "no udev rule grants access to bricks"
    yield Finding(
        "udev",
        Severity.WARN if facts.is_root else Severity.FAIL,
        what,
        "only root can open a brick over USB",
        " && ".join((f"nxt-twin udev | sudo tee {RULE_PATH}", *install_commands()[1:])),
    )


def check_usb(facts: MachineFacts) -> Iterable[Finding]:
    """Are there bricks on USB, and can they be used?"""
    if facts.usb_error:
        yield Finding(
            "usb", Severity.FAIL, facts.usb_error, "USB cannot be searched", "reboot, or use Bluetooth"
        )
    elif not facts.usb:
        yield Finding(
            "usb", Severity.WARN, "no brick on USB", "there is none to talk to", "plug it in and switch it on"
        )
    for brick in facts.usb:
        yield _usb_finding(brick)


def check_bluetooth(facts: MachineFacts) -> Iterable[Finding]:
    """Is there a Bluetooth stack that Python can use?"""
    if facts.bluetooth_sockets:
        yield Finding(
            "bluetooth",
            Severity.WARN,
            facts.bluetooth_sockets,
            "bt: cannot be used",
            "bind a serial port instead: sudo rfcomm bind 0 ADDRESS 1, then serial:/dev/rfcomm0",
        )
    else:
        yield Finding("bluetooth", Severity.OK, "Python and the system have Bluetooth sockets")
    if facts.system == "Linux" and not facts.bluetooth_adapters:
        yield Finding(
            "bluetooth adapter",
            Severity.WARN,
            "there is no Bluetooth adapter",
            "no brick can be reached by radio",
            "plug one in, or use USB",
        )
    elif facts.bluetooth_adapters:
        yield Finding("bluetooth adapter", Severity.OK, ", ".join(facts.bluetooth_adapters))
    if facts.system == "Linux" and "bluetoothctl" not in facts.bluetooth_tools:
        yield Finding(
            "bluetooth tools",
            Severity.WARN,
            "bluetoothctl is not there",
            "bricks cannot be paired from here",
            "sudo apt install bluez",
        )


def check_serial_ports(facts: MachineFacts) -> Iterable[Finding]:
    """May the serial ports be opened, and does another program have them open?"""
    if not facts.serial_ports:
        yield Finding("serial", Severity.OK, "no serial ports, which only Bluetooth without sockets needs")
    for port in facts.serial_ports:
        yield _serial_finding(port, facts.groups)


def _package_finding(package: PackageFacts) -> Finding:
    check = f"package {package.name}"
    if package.fits:
        return Finding(check, Severity.OK, f"{package.name} {package.installed}")
    have = f"{package.name} {package.installed}" if package.installed else f"{package.name} is missing"
    return Finding(
        check,
        Severity.FAIL,
        have,
        f"nxt-twin needs {package.name}{package.wanted}",
        f"pip install '{package.name}{package.wanted}'",
    )


def _usb_finding(brick: UsbFacts) -> Finding:
    if not brick.obstacle:
        return Finding("usb", Severity.OK, f"a brick at {brick.place}")
    return Finding(
        "usb", Severity.FAIL, f"{brick.place}: {brick.obstacle}", "this brick cannot be used", brick.mend
    )


def _serial_finding(port: SerialPortFacts, groups: frozenset[str]) -> Finding:
    if port.users:
        return Finding(
            "serial",
            Severity.WARN,
            f"{port.device} is in use by {', '.join(port.users)}",
            "a brick behind it cannot be reached meanwhile",
            "close that program",
        )
    if port.accessible:
        return Finding("serial", Severity.OK, f"{port.device} may be opened")
    if port.group in groups:
        why, mend = "the group was given after this login", "log out and in again"
    else:
        why, mend = (
            f"this user is not in the group {port.group}",
            f"sudo usermod -aG {port.group} $USER, then log in again",
        )
    return Finding("serial", Severity.FAIL, f"{port.device} may not be opened", why, mend)


_CHECKS: Final[tuple[Callable[[MachineFacts], Iterable[Finding]], ...]] = (
    check_python,
    check_packages,
    check_libusb,
    check_udev,
    check_usb,
    check_bluetooth,
    check_serial_ports,
)
