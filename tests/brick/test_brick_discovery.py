"""The search for bricks: all ways at once, and a reason where there is none."""

# ruff: noqa: ARG001, ARG005 - what stands in for something takes what that takes

from __future__ import annotations

import threading
from types import SimpleNamespace

import pytest
from brick_fakes import ScriptedLink, VirtualClock

from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.discovery import default_ways, search_ways
from nxt_twin.brick.errors import LinkRefusedError, LinkTimeoutError, Refusal
from nxt_twin.brick.search.bluetooth import look_on_bluetooth
from nxt_twin.brick.search.finding import FoundBrick, Reason, WayReport
from nxt_twin.brick.search.serial_ports import SerialPort, look_on_serial_ports

INFO = bytes.fromhex("029b00") + b"Robbie".ljust(15, b"\0") + bytes.fromhex("00165301020300") + bytes(8)


def found(way: str):
    return lambda clock: WayReport(way, (FoundBrick(f"{way}:x", "a brick"),))


def raising(error: Exception):
    def look(clock):
        raise error

    return look


def test_each_way_reports_in_the_order_in_which_they_were_named():
    reports = search_ways(SystemClock(), {"tcp": found("tcp"), "usb": found("usb")})
    assert [report.way for report in reports] == ["tcp", "usb"]
    assert reports[1].bricks[0].url == "usb:x"


def test_a_way_that_fails_says_why_and_spoils_no_other():
    refused = LinkRefusedError("no rule", cause=Refusal.NO_PERMISSION, where="bus 1", mend="nxt-twin udev")
    ways = {
        "usb": raising(refused),
        "serial": raising(ImportError("no module named serial")),
        "bt": raising(OSError("odd")),
        "tcp": found("tcp"),
    }
    usb, serial, bt, tcp = search_ways(SystemClock(), ways)
    assert usb.reasons == (Reason("bus 1: no rule", Refusal.NO_PERMISSION, "nxt-twin udev"),)
    assert serial.reasons[0].cause is Refusal.NO_DRIVER
    assert "odd" in bt.reasons[0].what
    assert tcp.bricks


def test_a_way_that_hangs_is_left_behind():
    release = threading.Event()

    def hang(clock):
        release.wait(10)
        return WayReport("usb")

    usb, tcp = search_ways(SystemClock(), {"usb": hang, "tcp": found("tcp")}, timeout_s=0.2)
    release.set()
    assert "did not come back within 0.2 s" in usb.reasons[0].what
    assert tcp.bricks


def test_ways_are_walked_at_the_same_time():
    meet = threading.Barrier(3)

    def look(way: str):
        def walk(clock):
            meet.wait(5)
            return WayReport(way)

        return walk

    reports = search_ways(SystemClock(), {way: look(way) for way in ("a", "b", "c")})
    assert all(not report.reasons for report in reports)


def test_every_link_but_the_mock_is_searched():
    assert list(default_ways()) == ["usb", "serial", "bt", "tcp"]


def test_only_serial_ports_that_look_like_a_brick_s_are_opened():
    clock = VirtualClock()
    opened: list[str] = []

    def open_port(device: str, _):
        opened.append(device)
        return ScriptedLink(clock, lambda sent: [INFO])

    ports = [SerialPort("/dev/rfcomm0", "Bluetooth"), SerialPort("/dev/ttyACM0", "Arduino Uno")]
    report = look_on_serial_ports(clock, ports=lambda: ports, opener=open_port)
    assert opened == ["/dev/rfcomm0"]
    assert report.bricks == (FoundBrick("serial:/dev/rfcomm0", "Robbie on /dev/rfcomm0"),)


def test_a_search_of_serial_ports_moves_nothing():
    clock = VirtualClock()
    link = ScriptedLink(clock, lambda sent: [INFO])
    look_on_serial_ports(
        clock, ports=lambda: [SerialPort("COM5", "BTHENUM 001653010203")], opener=lambda *_: link
    )
    assert [sent.hex() for sent in link.sent] == ["019b"]
    assert link.closed


def test_a_brick_s_port_that_does_not_answer_gives_the_reason():
    def refuse(device: str, clock):
        raise LinkTimeoutError("nothing came", where=device)

    ports = [SerialPort("/dev/rfcomm0", ""), SerialPort("/dev/ttyS0", "")]
    report = look_on_serial_ports(VirtualClock(), ports=lambda: ports, opener=refuse)
    assert [reason.what for reason in report.reasons] == [
        "/dev/rfcomm0: nothing came",
        "ports that do not look like a brick's were left alone: /dev/ttyS0",
    ]


def test_no_serial_ports_at_all_says_how_to_get_one():
    (reason,) = look_on_serial_ports(VirtualClock(), ports=list).reasons
    assert "rfcomm bind" in reason.mend


def working_sockets() -> SimpleNamespace:
    return SimpleNamespace(
        AF_BLUETOOTH=31,
        BTPROTO_RFCOMM=3,
        SOCK_STREAM=1,
        socket=lambda *_: SimpleNamespace(close=lambda: None),
    )


def test_paired_bricks_are_told_from_other_paired_devices():
    listing = "Device 00:16:53:01:02:03 Robbie\nDevice AA:BB:CC:DD:EE:FF Headset\n"
    report = look_on_bluetooth(VirtualClock(), devices=lambda: listing, sockets=working_sockets())
    assert report.bricks == (FoundBrick("bt:00:16:53:01:02:03", "Robbie"),)
    assert report.reasons == ()


def test_no_paired_brick_says_how_to_pair_one():
    (reason,) = look_on_bluetooth(VirtualClock(), devices=lambda: "", sockets=working_sockets()).reasons
    assert "1234" in reason.mend


def test_without_bluetooth_sockets_the_search_says_so():
    with pytest.raises(LinkRefusedError) as caught:
        look_on_bluetooth(VirtualClock(), devices=lambda: "", sockets=SimpleNamespace())
    assert caught.value.cause is Refusal.NO_DRIVER
