"""Bricks that this computer is paired with. The radio is not used: a paired brick may be off or far away."""

from __future__ import annotations

import re
import shutil
import socket
import subprocess
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Final

from firmware_protocol.bluetooth import ADDRESS_PREFIX, DEFAULT_PIN
from nxt_twin.brick.clock import Clock
from nxt_twin.brick.errors import LinkRefusedError, Refusal
from nxt_twin.brick.links.bluetooth import lacks_sockets, serial_port_advice
from nxt_twin.brick.search.finding import FoundBrick, Reason, WayReport

_ASK_TIMEOUT_S: Final = 5.0
_PAIR: Final = (
    f"switch the brick's Bluetooth on and pair it, PIN {DEFAULT_PIN}: bluetoothctl scan on; pair ADDRESS"
)
_DEVICE: Final = re.compile(rf"Device ({ADDRESS_PREFIX}(?::[0-9A-F]{{2}}){{3}}) (.*)")


def paired_devices() -> str:
    """What ``bluetoothctl devices`` prints.

    Raises:
        LinkRefusedError: there is no bluetoothctl, no adapter, or no answer.
    """
    program = shutil.which("bluetoothctl")
    if program is None:
        raise LinkRefusedError(
            "bluetoothctl is not there, which knows the paired devices",
            cause=Refusal.NO_DRIVER,
            mend="sudo apt install bluez; or name the brick: bt:ADDRESS",
        )
    if not any(Path("/sys/class/bluetooth").glob("hci*")):
        raise LinkRefusedError(
            "there is no Bluetooth adapter", cause=Refusal.NO_ADAPTER, mend="plug one in, or use USB"
        )
    try:
        asked = subprocess.run(  # noqa: S603 - the program's full path, and no input of a user
            [program, "devices"], capture_output=True, text=True, timeout=_ASK_TIMEOUT_S, check=False
        )
    except subprocess.TimeoutExpired as error:
        raise LinkRefusedError(
            "the Bluetooth service does not answer",
            cause=Refusal.NO_DRIVER,
            mend="sudo systemctl restart bluetooth",
        ) from error
    return asked.stdout


def look_on_bluetooth(
    clock: Clock, *, devices: Callable[[], str] = paired_devices, sockets: ModuleType = socket
) -> WayReport:
    """The paired bricks, by LEGO's share of the address space.

    Args:
        clock: not needed here.
        devices: gives the paired devices.
        sockets: the module `socket`, or what stands for it.

    Raises:
        LinkRefusedError: the paired devices cannot be listed.
    """
    del clock
    lack = lacks_sockets(sockets)
    if lack:
        raise LinkRefusedError(lack, cause=Refusal.NO_DRIVER, mend=serial_port_advice("ADDRESS"))
    found = [FoundBrick(f"bt:{address}", name.strip()) for address, name in _DEVICE.findall(devices())]
    reasons = () if found else (Reason("no brick is paired with this computer", Refusal.NOT_FOUND, _PAIR),)
    return WayReport("bt", tuple(found), reasons)
