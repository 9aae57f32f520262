"""Bricks on USB: read from their descriptors, without opening or resetting one."""

from __future__ import annotations

from nxt_twin.brick.clock import Clock
from nxt_twin.brick.errors import Refusal
from nxt_twin.brick.links.usb_devices import (
    UsbBackend,
    boot_mode_refusal,
    default_backend,
    find_booting,
    find_bricks,
)
from nxt_twin.brick.search.finding import FoundBrick, Reason, WayReport, reason_of


def look_on_usb(clock: Clock, *, backend: UsbBackend = None) -> WayReport:
    """The bricks on USB, and those there that cannot be used.

    Args:
        clock: not needed here.
        backend: pyusb's backend; None for the libusb that comes along.

    Raises:
        LinkRefusedError: this machine has no libusb or no USB.
    """
    del clock
    chosen = default_backend() if backend is None else backend
    bricks: list[FoundBrick] = []
    reasons: list[Reason] = []
    for found in find_bricks(chosen):
        if found.obstacle:
            reasons.append(reason_of(found.obstacle))
        else:
            bricks.append(FoundBrick(f"usb:{found.serial}", found.place))
    reasons += [reason_of(boot_mode_refusal(place)) for place in find_booting(chosen)]
    if not bricks and not reasons:
        mend = "plug it in and switch it on"
        reasons.append(Reason("there is no brick on USB", Refusal.NOT_FOUND, mend))
    return WayReport("usb", tuple(bricks), tuple(reasons))
