"""Serves a function `bytes -> bytes` as a brick's other end: in process, over a socket pair, TCP or a pty."""

from __future__ import annotations

import contextlib
import os
import select
import socket
import threading
import tty
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from firmware_protocol import FrameSplitter, frame
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.errors import LinkTimeoutError
from nxt_twin.brick.link import Link
from nxt_twin.brick.links.sockets import SocketStream
from nxt_twin.brick.links.stream import StreamLink
from nxt_twin.brick.open import open_brick
from nxt_twin.brick.policy import STREAM_POLICY

Answer = Callable[[bytes], bytes | None]
OpenBrick = Callable[[], Brick]

_WAKE_S = 0.02


class DirectLink:
    """A link whose other end is a function; nothing waits."""

    def __init__(self, answer: Answer) -> None:
        self._answer = answer
        self._replies: deque[bytes] = deque()

    def send(self, telegram: bytes) -> None:
        reply = self._answer(telegram)
        if reply is not None:
            self._replies.append(reply)

    def receive(self, timeout_s: float) -> bytes:
        if not self._replies:
            raise LinkTimeoutError(f"nothing came within {timeout_s:g} s")
        return self._replies.popleft()

    def close(self) -> None:
        self._replies.clear()

    def describe(self) -> str:
        return "direct"


@contextmanager
def served_directly(answer: Answer) -> Iterator[OpenBrick]:
    yield lambda: Brick(DirectLink(answer), SystemClock())


@contextmanager
def served_by_socket_pair(answer: Answer) -> Iterator[OpenBrick]:
    with contextlib.ExitStack() as stack:

        def connect() -> Brick:
            near, far = socket.socketpair()
            stack.enter_context(_thread(lambda stop: _serve_socket(far, answer, stop)))
            link: Link = StreamLink(SocketStream(near, "pair"), SystemClock(), "pair")
            return Brick(link, SystemClock(), STREAM_POLICY)

        yield connect


@contextmanager
def served_by_tcp(answer: Answer) -> Iterator[OpenBrick]:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        listener.settimeout(_WAKE_S)
        with _thread(lambda stop: _accept(listener, answer, stop)):
            url = f"tcp:127.0.0.1:{listener.getsockname()[1]}"
            yield lambda: open_brick(url, SystemClock())


@contextmanager
def served_by_pty(answer: Answer) -> Iterator[OpenBrick]:
    controller, terminal = os.openpty()
    tty.setraw(terminal)
    try:
        with _thread(lambda stop: _serve_pty(controller, answer, stop)):
            yield lambda: open_brick(f"serial:{os.ttyname(terminal)}", SystemClock())
    finally:
        os.close(terminal)
        os.close(controller)


@contextmanager
def _thread(work: Callable[[threading.Event], None]) -> Iterator[None]:
    stop = threading.Event()
    thread = threading.Thread(target=work, args=(stop,), daemon=True)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()


def _accept(listener: socket.socket, answer: Answer, stop: threading.Event) -> None:
    while not stop.is_set():
        with contextlib.suppress(TimeoutError):
            _serve_socket(listener.accept()[0], answer, stop)


def _serve_socket(far: socket.socket, answer: Answer, stop: threading.Event) -> None:
    splitter = FrameSplitter()
    far.settimeout(_WAKE_S)
    with far:
        while not stop.is_set():
            try:
                data = far.recv(4096)
            except TimeoutError:
                continue
            except OSError:
                return
            if not data:
                return
            with contextlib.suppress(OSError):
                far.sendall(_answers(splitter, data, answer))


def _serve_pty(controller: int, answer: Answer, stop: threading.Event) -> None:
    splitter = FrameSplitter()
    while not stop.is_set():
        if select.select([controller], [], [], _WAKE_S)[0]:
            os.write(controller, _answers(splitter, os.read(controller, 4096), answer))


def _answers(splitter: FrameSplitter, data: bytes, answer: Answer) -> bytes:
    replies = [answer(telegram) for telegram in splitter.feed(data)]
    return b"".join(frame(reply) for reply in replies if reply is not None)
