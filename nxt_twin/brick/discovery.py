"""Search for bricks on all ways at once. Looking moves nothing, and says why where nothing is found."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

from nxt_twin.brick.clock import Clock
from nxt_twin.brick.errors import BrickError, Refusal
from nxt_twin.brick.search.finding import Reason, WayReport, reason_of

SEARCH_TIMEOUT_S: Final = 8.0


Look = Callable[[Clock], WayReport]
"""Looks along one way; raises `BrickError` where it cannot."""


def search_ways(
    clock: Clock, ways: Mapping[str, Look], *, timeout_s: float = SEARCH_TIMEOUT_S
) -> tuple[WayReport, ...]:
    """Look along all ways at once.

    Args:
        clock: passed on to the ways.
        ways: the ways by name, such as `default_ways` gives.
        timeout_s: how long to wait for all of them together, in real time.

    Returns:
        One report a way, in their order; a way that did not come back in time says so.
    """
    reports: queue.SimpleQueue[WayReport] = queue.SimpleQueue()

    def walk(way: str, look: Look) -> None:
        reports.put(_report_of(way, look, clock))

    for way, look in ways.items():
        # A way that hangs in a driver must not keep the program from ending.
        threading.Thread(target=walk, args=(way, look), name=f"search-{way}", daemon=True).start()
    back = _collect(reports, len(ways), clock, timeout_s)
    late = Reason(f"the search did not come back within {timeout_s:g} s", cause=None)
    return tuple(back.get(way, WayReport(way, reasons=(late,))) for way in ways)


def default_ways() -> Mapping[str, Look]:
    """Every way that this package knows."""
    return _DEFAULT_WAYS


def _report_of(way: str, look: Look, clock: Clock) -> WayReport:
    try:
        return look(clock)
    except BrickError as error:
        return WayReport(way, reasons=(reason_of(error),))
    except ImportError as error:
        return WayReport(way, reasons=(Reason(str(error), Refusal.NO_DRIVER, "reinstall nxt-twin"),))
    except OSError as error:
        return WayReport(way, reasons=(Reason(f"the search failed: {error}", cause=None),))


def _collect(
    reports: queue.SimpleQueue[WayReport], count: int, clock: Clock, timeout_s: float
) -> dict[str, WayReport]:
    back: dict[str, WayReport] = {}
    give_up_s = clock.now_s() + timeout_s
    while len(back) < count:
        try:
            report = reports.get(timeout=max(0.0, give_up_s - clock.now_s()))
        except queue.Empty:
            break
        back[report.way] = report
    return back


def _look_on_usb(clock: Clock) -> WayReport:
    from nxt_twin.brick.search.usb import look_on_usb

    return look_on_usb(clock)


def _look_on_serial_ports(clock: Clock) -> WayReport:
    from nxt_twin.brick.search.serial_ports import look_on_serial_ports

    return look_on_serial_ports(clock)


def _look_on_bluetooth(clock: Clock) -> WayReport:
    from nxt_twin.brick.search.bluetooth import look_on_bluetooth

    return look_on_bluetooth(clock)


def _look_on_tcp(clock: Clock) -> WayReport:
    from nxt_twin.brick.search.tcp import look_on_tcp

    return look_on_tcp(clock)


_DEFAULT_WAYS: Final[Mapping[str, Look]] = MappingProxyType(
    {"usb": _look_on_usb, "serial": _look_on_serial_ports, "bt": _look_on_bluetooth, "tcp": _look_on_tcp}
)
