"""What answers in the round trip benchmarks, each in a process of its own: an echo, or the mock brick."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import tty
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from firmware_protocol import FrameSplitter, frame
from nxt_twin.brick.clock import SystemClock


class EchoLink:
    """A link that costs nothing: the reply is there at once."""

    def __init__(self) -> None:
        self._reply = b""

    def send(self, telegram: bytes) -> None:
        self._reply = reply_to(telegram)

    def receive(self, timeout_s: float) -> bytes:
        del timeout_s
        return self._reply

    def close(self) -> None:
        self._reply = b""

    def describe(self) -> str:
        return "echo"


class MockPlaces(NamedTuple):
    """Where the mock brick is reached."""

    tcp: str
    pty: str


def reply_to(telegram: bytes) -> bytes:
    if telegram[1] == 0x06:
        return b"\x02\x06\x00" + telegram[2:3] + bytes(21)
    if telegram[1] == 0x07:
        return b"\x02\x07\x00" + telegram[2:3] + b"\x01" + bytes(11)
    if telegram[1] == 0x88:
        return b"\x02\x88\x00\x7c\x01\x1d\x01"
    return b"\x02\x0b\x00\x10\x20"


@contextmanager
def echo_on_tcp() -> Iterator[str]:
    """Gives HOST:PORT, for one client."""
    with socket.create_server(("127.0.0.1", 0)) as server, _peer("echo-tcp", server.fileno()):
        yield f"127.0.0.1:{server.getsockname()[1]}"


@contextmanager
def echo_on_pty() -> Iterator[str]:
    """Gives the device, which any number of handles may share that take turns."""
    controller, terminal = os.openpty()
    tty.setraw(terminal)
    try:
        with _peer("echo", controller):
            yield os.ttyname(terminal)
    finally:
        os.close(controller)
        os.close(terminal)


@contextmanager
def mock_brick() -> Iterator[MockPlaces]:
    """The mock brick in real time, for one client at a time."""
    with TemporaryDirectory() as folder, _peer("mock", link := f"{folder}/brick") as url:
        yield MockPlaces(url.removeprefix("tcp:"), link)


@contextmanager
def _peer(peer: str, argument: int | str) -> Iterator[str]:
    """Gives the line that the process prints when it is ready."""
    handles = [argument] if isinstance(argument, int) else []
    command = [sys.executable, "-m", __spec__.name, peer, str(argument)]
    with subprocess.Popen(command, pass_fds=handles, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            yield process.stdout.readline().strip()
        finally:
            process.kill()


def _echo(handle: int) -> None:
    splitter = FrameSplitter()
    while data := os.read(handle, 4096):
        for telegram in splitter.feed(data):
            os.write(handle, frame(reply_to(telegram)))


def _echo_on_tcp(handle: int) -> None:
    client, _ = socket.socket(fileno=handle).accept()
    client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    _echo(client.fileno())


def _mock(link: str) -> None:
    from nxt_twin.mock.run import Served, serve

    def announce(served: Served) -> None:
        print(served.urls[0], flush=True)

    serve(clock=SystemClock(), announce=announce, tcp="127.0.0.1:0", pty=Path(link))


def _serve(peer: str, argument: str) -> None:
    if peer == "mock":
        _mock(argument)
        return
    print("ready", flush=True)
    if peer == "echo-tcp":
        _echo_on_tcp(int(argument))
    else:
        _echo(int(argument))


if __name__ == "__main__":
    _serve(*sys.argv[1:])
