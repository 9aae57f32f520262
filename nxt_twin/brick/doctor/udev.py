"""The udev rule that lets whoever sits at the machine use a brick on USB."""

from __future__ import annotations

import re
from pathlib import PurePath
from typing import Final

from firmware_protocol.usb import BOOT_PRODUCT_ID, BOOT_VENDOR_ID, PRODUCT_ID, VENDOR_ID

RULE_PATH: Final = "/etc/udev/rules.d/70-nxt-twin.rules"
"""Below 73, because the rules of that number turn the tag into access."""

_ACCESS_NUMBER: Final = 73


def rule_text() -> str:
    """The rule file: an NXT, and one in firmware download mode."""
    lines = [
        "# Access to LEGO Mindstorms NXT bricks on USB for the user at the machine (nxt-twin udev).",
        _rule(VENDOR_ID, PRODUCT_ID),
        "# The same brick in firmware download mode (SAM-BA).",
        _rule(BOOT_VENDOR_ID, BOOT_PRODUCT_ID),
    ]
    return "\n".join(lines) + "\n"


def install_commands() -> tuple[str, ...]:
    """The commands that put the rule in force."""
    return (
        f"nxt-twin udev | sudo tee {RULE_PATH}",
        "sudo udevadm control --reload",
        "sudo udevadm trigger --subsystem-match=usb",
    )


def rule_grants(path: str, text: str) -> bool:
    """Whether a rule file lets users open a brick.

    Args:
        path: where it is; its number matters.
        text: what it says.
    """
    return any(_line_grants(path, line) for line in text.splitlines())


def names_a_brick(text: str) -> bool:
    """Whether a rule file says anything about NXT bricks, comments aside."""
    return any(_is_about_a_brick(line) for line in text.splitlines())


def comes_too_late(path: str) -> bool:
    """Whether a rule file is read after the rules that turn the tag ``uaccess`` into access."""
    number = re.match(r"\d+", PurePath(path).name)
    return number is None or int(number.group()) >= _ACCESS_NUMBER


def _line_grants(path: str, line: str) -> bool:
    if not _is_about_a_brick(line):
        return False
    tagged = re.search(r'TAG\s*\+?=\s*"uaccess"', line) is not None
    opened = re.search(r'MODE\s*:?=\s*"0?66[46]"', line) is not None
    return opened or (tagged and not comes_too_late(path))


def _is_about_a_brick(line: str) -> bool:
    rule = line.partition("#")[0].lower()
    return f'"{VENDOR_ID:04x}"' in rule


def _rule(vendor: int, product: int) -> str:
    return (
        f'SUBSYSTEM=="usb", ATTR{{idVendor}}=="{vendor:04x}", ATTR{{idProduct}}=="{product:04x}",'
        ' TAG+="uaccess"'
    )
