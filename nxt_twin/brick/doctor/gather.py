"""Asks this machine for the facts; changes nothing."""

from __future__ import annotations

import os
import platform
import shutil
import socket
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Final

from nxt_twin.brick.doctor.facts import MachineFacts, RuleFile, SerialPortFacts, UsbFacts
from nxt_twin.brick.doctor.packages import installed_packages
from nxt_twin.brick.doctor.udev import names_a_brick
from nxt_twin.brick.errors import LinkRefusedError
from nxt_twin.brick.links.bluetooth import lacks_sockets
from nxt_twin.brick.links.usb_devices import (
    UsbBackend,
    boot_mode_refusal,
    default_backend,
    find_booting,
    find_bricks,
)
from nxt_twin.brick.search.serial_ports import serial_ports

_RULE_FOLDERS: Final = (
    "/etc/udev/rules.d",
    "/run/udev/rules.d",
    "/usr/lib/udev/rules.d",
    "/lib/udev/rules.d",
)
_BLUETOOTH_TOOLS: Final = ("bluetoothctl", "rfcomm")


def gather_facts() -> MachineFacts:
    """The facts about this machine and this user."""
    libusb, usb, usb_error = _usb_facts(default_backend)
    return MachineFacts(
        system=platform.system(),
        python=sys.version_info[:3],
        is_root=hasattr(os, "geteuid") and os.geteuid() == 0,
        groups=_groups(),
        udev_rules=brick_rules(Path(folder) for folder in _RULE_FOLDERS),
        libusb=libusb,
        usb=usb,
        usb_error=usb_error,
        bluetooth_sockets=lacks_sockets(socket),
        bluetooth_adapters=tuple(path.name for path in sorted(Path("/sys/class/bluetooth").glob("hci*"))),
        bluetooth_tools=frozenset(tool for tool in _BLUETOOTH_TOOLS if shutil.which(tool)),
        serial_ports=tuple(_serial_facts(port.device) for port in serial_ports()),
        packages=installed_packages(),
    )


def brick_rules(folders: Iterable[Path]) -> tuple[RuleFile, ...]:
    """The rule files of udev that name an NXT; a name in an earlier folder hides the later ones."""
    by_name: dict[str, Path] = {}
    for folder in folders:
        for path in sorted(folder.glob("*.rules")):
            by_name.setdefault(path.name, path)
    rules = (RuleFile(str(path), _text(path)) for path in by_name.values())
    return tuple(rule for rule in rules if names_a_brick(rule.text))


def users_of(device: str, processes: Path = Path("/proc")) -> tuple[str, ...]:
    """The programs that have a device open, as far as this user may see.

    Args:
        device: its path.
        processes: where the system shows its processes, if it does.
    """
    users: list[str] = []
    for process in processes.glob("[0-9]*"):
        try:
            opened = {str(handle.readlink()) for handle in (process / "fd").iterdir()}
        except OSError:
            continue  # gone meanwhile, or another user's
        if device in opened:
            users.append(f"{_text(process / 'comm').strip() or 'a program'} ({process.name})")
    return tuple(sorted(users))


def _usb_facts(load: Callable[[], UsbBackend]) -> tuple[str, tuple[UsbFacts, ...], str]:
    try:
        backend = load()
    except LinkRefusedError as error:
        return error.what, (), ""
    try:
        bricks = [
            UsbFacts(brick.place, brick.obstacle.what, brick.obstacle.mend)
            if brick.obstacle
            else UsbFacts(brick.place)
            for brick in find_bricks(backend)
        ]
        refusals = [(place, boot_mode_refusal(place)) for place in find_booting(backend)]
    except LinkRefusedError as error:
        return "", (), error.what
    return "", (*bricks, *(UsbFacts(place, error.what, error.mend) for place, error in refusals)), ""


def _serial_facts(device: str) -> SerialPortFacts:
    return SerialPortFacts(
        device,
        group=_group_of(device),
        accessible=os.access(device, os.R_OK | os.W_OK),
        users=users_of(str(Path(device).resolve())),
    )


def _groups() -> frozenset[str]:
    if not hasattr(os, "getgroups"):
        return frozenset()
    import grp  # Windows has none

    names: set[str] = set()
    for number in os.getgroups():
        try:
            names.add(grp.getgrgid(number).gr_name)
        except KeyError:
            names.add(str(number))
    return frozenset(names)


def _group_of(device: str) -> str:
    try:
        return Path(device).group()
    except (OSError, KeyError, NotImplementedError):
        return ""


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""
