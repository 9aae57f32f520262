"""URLs, and why links cannot be opened."""

# ruff: noqa: ARG001, ARG005 - what stands in for something takes what that takes

from __future__ import annotations

import errno
import os
import socket
import subprocess
import sys
import threading
from types import SimpleNamespace

import pytest
import serial
from brick_fakes import ScriptedLink, VirtualClock

from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.errors import LinkLostError, LinkRefusedError, LinkTimeoutError, LinkUrlError, Refusal
from nxt_twin.brick.links.bluetooth import open_bluetooth
from nxt_twin.brick.links.serial_port import open_serial
from nxt_twin.brick.links.sockets import SocketStream
from nxt_twin.brick.open import open_brick, open_link
from nxt_twin.brick.url import host_and_port

ADDRESS = "00:16:53:01:02:03"


@pytest.mark.parametrize("url", ["", "nxt", "ftp:there", ":x", "/dev/rfcomm0"])
def test_a_url_without_a_known_scheme_lists_the_schemes(url: str):
    with pytest.raises(LinkUrlError, match=r"usb:, bt:, serial:, tcp:, mock:"):
        open_link(url, VirtualClock(), {"mock": lambda address, clock: None})


@pytest.mark.parametrize(
    "url", ["bt:", "bt:00:16:53", "bt:zz:16:53:01:02:03", "usb:12", "tcp:", "tcp:host", "tcp:host:0",
            "tcp::80", "tcp:host:99999", "tcp://host:80", "serial:"],
)  # fmt: skip
def test_an_address_that_is_none_is_wrong_use(url: str):
    with pytest.raises(LinkUrlError):
        open_link(url, VirtualClock())


def test_an_ipv6_host_stands_in_brackets():
    assert host_and_port("[::1]:7000") == ("::1", 7000)


def test_a_further_scheme_is_opened_by_what_the_caller_passes():
    clock = VirtualClock()
    link = ScriptedLink(clock, lambda _: [b"\x02\x0b\x00\x10\x20"])
    with open_brick(
        "mock:seed=1", clock, {"mock": lambda address, _: link if address == "seed=1" else None}
    ) as brick:
        assert brick.device.battery_v().value == pytest.approx(8.208)


def test_opening_one_way_imports_no_library_of_another():
    code = (
        "import sys\nfrom nxt_twin.brick.open import open_link\n"
        "from nxt_twin.brick.clock import SystemClock\n"
        "try: open_link('tcp:127.0.0.1:1', SystemClock())\n"
        "except Exception as error: print(type(error).__name__)\n"
        "print([name for name in ('usb', 'serial', 'libusb_package') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split("\n")[:2] == ["LinkRefusedError", "[]"]


def test_tcp_without_a_listener_says_how_to_start_one():
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    with pytest.raises(LinkRefusedError) as caught:
        open_link(f"tcp:127.0.0.1:{port}", SystemClock())
    assert caught.value.cause is Refusal.NOT_FOUND
    assert f"nxt-twin mock --tcp 127.0.0.1:{port}" in caught.value.mend


def bluetooth_refusal(sockets) -> LinkRefusedError:
    with pytest.raises(LinkRefusedError) as caught:
        open_bluetooth(ADDRESS, VirtualClock(), sockets=sockets)
    return caught.value


def test_a_python_without_bluetooth_says_so_and_how_to_bind_a_serial_port():
    error = bluetooth_refusal(SimpleNamespace())
    assert error.cause is Refusal.NO_DRIVER
    assert "built without" in error.what
    assert f"rfcomm bind 0 {ADDRESS} 1" in error.mend


class FakeBluetooth:
    """What stands for the module `socket` on a machine with Bluetooth."""

    AF_BLUETOOTH, BTPROTO_RFCOMM, SOCK_STREAM = 31, 3, 1

    def __init__(self, *, made: int = 0, connected: int = 0) -> None:
        self._made, self._connected = made, connected
        self.near, self.far = socket.socketpair()
        self.target: object = None
        self.closed = 0
        # The link reads names from the module's own dictionary.
        self.__dict__.update(AF_BLUETOOTH=31, BTPROTO_RFCOMM=3)

    def socket(self, family: int, kind: int, protocol: int):
        assert (family, kind, protocol) == (31, 1, 3)
        if self._made:
            raise OSError(self._made, os.strerror(self._made))
        return self

    def settimeout(self, timeout_s: float) -> None:
        self.near.settimeout(timeout_s)

    def fileno(self) -> int:
        return self.near.fileno()

    def connect(self, target: tuple[str, int]) -> None:
        if self._connected:
            raise OSError(self._connected, os.strerror(self._connected))
        self.target = target

    def send(self, data: bytes) -> int:
        return self.near.send(data)

    def recv(self, size: int) -> bytes:
        return self.near.recv(size)

    def close(self) -> None:
        self.closed += 1


def test_a_kernel_without_bluetooth_says_so():
    fake = FakeBluetooth(made=errno.EAFNOSUPPORT)
    error = bluetooth_refusal(fake)
    assert error.cause is Refusal.NO_DRIVER
    assert "kernel" in error.what
    fake.near.close()
    fake.far.close()


@pytest.mark.parametrize(
    ("number", "cause"),
    [
        (errno.EHOSTDOWN, Refusal.UNREACHABLE),
        (errno.EHOSTUNREACH, Refusal.NO_ADAPTER),
        (errno.EACCES, Refusal.NO_PERMISSION),
        (errno.EBUSY, Refusal.BUSY),
        (errno.ETIMEDOUT, Refusal.UNREACHABLE),
    ],
)
def test_why_a_bluetooth_brick_does_not_answer_is_told(number: int, cause: Refusal):
    fake = FakeBluetooth(connected=number)
    assert bluetooth_refusal(fake).cause is cause
    assert fake.closed == 2
    fake.near.close()
    fake.far.close()


def test_a_bluetooth_brick_is_spoken_to_on_the_serial_port_profile():
    fake = FakeBluetooth()
    link = open_bluetooth(ADDRESS.lower(), VirtualClock(), sockets=fake)
    assert fake.target == (ADDRESS, 1)
    link.send(b"\x00\x0b")
    assert fake.far.recv(10) == b"\x02\x00\x00\x0b"
    fake.near.close()
    fake.far.close()


def test_a_serial_port_that_is_not_there_says_so(tmp_path):
    with pytest.raises(LinkRefusedError) as caught:
        open_serial(str(tmp_path / "rfcomm0"), VirtualClock())
    assert caught.value.cause is Refusal.NOT_FOUND


def test_a_serial_port_that_another_program_holds_is_busy():
    controller, terminal = os.openpty()
    first = open_serial(os.ttyname(terminal), SystemClock())
    with pytest.raises(LinkRefusedError) as caught:
        open_serial(os.ttyname(terminal), SystemClock())
    assert caught.value.cause is Refusal.BUSY
    first.close()
    os.close(controller)
    os.close(terminal)


@pytest.mark.parametrize(
    ("number", "cause", "mend"),
    [
        (errno.EACCES, Refusal.NO_PERMISSION, "usermod -aG dialout"),
        (errno.EHOSTDOWN, Refusal.UNREACHABLE, "pair"),
        (errno.EIO, Refusal.NO_DRIVER, ""),
    ],
)
def test_why_a_serial_port_cannot_be_opened_is_told(monkeypatch, number: int, cause: Refusal, mend: str):
    def refuse(*args, **settings):
        raise serial.SerialException(number, "could not open port")

    monkeypatch.setattr(serial.Serial, "open", refuse)
    with pytest.raises(LinkRefusedError) as caught:
        open_serial("/dev/rfcomm0", VirtualClock())
    assert caught.value.cause is cause
    assert mend in caught.value.mend


@pytest.mark.skipif(os.name == "nt", reason="ports are no files there")
def test_a_terminal_that_nobody_reads_takes_no_more_and_does_not_hang(monkeypatch):
    from nxt_twin.brick.links import terminal

    monkeypatch.setattr(terminal, "_WRITE_TIMEOUT_MS", 50)
    controller, device = os.openpty()
    try:
        link = open_serial(os.ttyname(device), SystemClock())
        with pytest.raises(LinkTimeoutError, match="takes no more"):
            all(link.send(bytes(100)) is None for _ in range(10_000))
        link.close()
    finally:
        os.close(device)
        os.close(controller)


def test_a_peer_that_reads_nothing_stalls_a_socket_no_longer_than_its_timeout(monkeypatch):
    monkeypatch.setattr("nxt_twin.brick.links.sockets._WRITE_TIMEOUT_S", 0.01)
    near, far = socket.socketpair()
    stream = SocketStream(near, "pair")
    with far, pytest.raises(LinkTimeoutError, match="no more bytes"):
        stream.write(bytes(1 << 22))
    stream.close()


def test_what_fits_a_socket_only_in_parts_arrives_whole():
    near, far = socket.socketpair()
    stream = SocketStream(near, "pair")
    data = bytes(range(256)) * (1 << 12)
    got = bytearray()

    def take() -> None:
        while len(got) < len(data):
            got.extend(far.recv(1 << 16))

    reader = threading.Thread(target=take)
    reader.start()
    stream.write(data)
    reader.join()
    assert bytes(got) == data
    assert stream.read(0.0) == b""
    far.close()
    with pytest.raises(LinkLostError, match="closed it"):
        stream.read(1.0)
    stream.close()
