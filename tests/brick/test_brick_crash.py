"""A program that ends without leaving its brick: the motors coast all the same."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
import time

import pytest

from firmware_protocol import FrameSplitter, frame

PROGRAM = """
import signal, sys, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job has it ignored
from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.open import open_brick
brick = open_brick(sys.argv[1], SystemClock())
brick.motors.drive(0, 50, confirm=False)
if sys.argv[2] == "exit": sys.exit(3)
if sys.argv[2] == "raise": raise ZeroDivisionError
time.sleep(30)
"""


@pytest.mark.parametrize("way", ["exit", "raise", "ctrl-c"])
def test_the_end_of_the_interpreter_lets_motors_coast(way: str):
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(20)
        url = f"tcp:127.0.0.1:{server.getsockname()[1]}"
        program = subprocess.Popen([sys.executable, "-c", PROGRAM, url, way], stderr=subprocess.DEVNULL)
        far, _ = server.accept()
        far.settimeout(20)
        telegrams = list(_serve(far, program, interrupt=way == "ctrl-c"))
        program.wait(20)
    assert telegrams[0][:4] == b"\x80\x04\x00\x32"
    assert telegrams[1] == bytes.fromhex("8004ff000000000000000000")
    assert program.returncode != 0


def _serve(far: socket.socket, program: subprocess.Popen, *, interrupt: bool):
    splitter = FrameSplitter()
    with far:
        while data := far.recv(4096):
            for telegram in splitter.feed(data):
                yield telegram
                if telegram[1] == 0x94:
                    length = telegram[8]
                    far.sendall(frame(b"\x02\x94\x00" + telegram[2:6] + telegram[8:10] + bytes(length)))
                if interrupt:
                    interrupt = False
                    time.sleep(0.3)
                    program.send_signal(signal.SIGINT)
