"""A robot controller made of software that speaks the NX100's Ethernet protocol, faults included."""

from __future__ import annotations

import math
import socket
import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Final, final

from nxt_twin.brick.clock import Clock

_START_POSE: Final = (353.769, 202.779, 120.658, -1.34, 35.78, 27.84)
_BANNER: Final = "OK: NX Information Server(1.10) Keep-Alive:{count}."
_MOTION_DATA: Final = 17


@final
@dataclass
class RobotState:
    """The robot and its controller; tests set faults in here.

    Attributes:
        clock: moves take time by it.
        pose: X, Y, Z mm, Rx, Ry, Rz deg where the present move began.
        reach_mm: how far from the start a coordinate may be sent.
        remote, servo_on, held, alarm: as the controller's panel shows.
        refuse_session: another host is connected.
        alarm_after: raises an alarm when this number of moves was begun; none if negative.
    """

    clock: Clock
    pose: tuple[float, ...] = _START_POSE
    reach_mm: float = 1600.0
    remote: bool = True
    servo_on: bool = False
    held: bool = False
    alarm: bool = False
    refuse_session: bool = False
    alarm_after: int = -1
    moves: int = 0
    speeds: list[float] = field(default_factory=list)
    _target: tuple[float, ...] = _START_POSE
    _began_s: float = 0.0
    _ends_s: float = 0.0

    def now(self) -> tuple[float, ...]:
        """The pose now: on the straight way from where the move began."""
        span_s = self._ends_s - self._began_s
        share = 1.0 if span_s <= 0.0 else min(1.0, (self.clock.now_s() - self._began_s) / span_s)
        return tuple(a + share * (b - a) for a, b in zip(self.pose, self._target, strict=True))

    @property
    def running(self) -> bool:
        """Whether a move is under way."""
        return self.clock.now_s() < self._ends_s

    def halt(self) -> None:
        """Stand still where it is."""
        self.pose = self._target = self.now()
        self._ends_s = self._began_s = self.clock.now_s()

    def begin(self, target: tuple[float, ...], speed: float, *, by_posture: bool) -> None:
        """Begin a straight move."""
        self.halt()
        part = slice(3, 6) if by_posture else slice(0, 3)
        way = math.dist(self.pose[part], target[part])
        self._target = target
        self._ends_s = self._began_s + way / speed
        self.moves += 1
        self.speeds.append(speed)
        if 0 <= self.alarm_after <= self.moves:
            self._ends_s = self._began_s + 0.5 * way / speed
            self._target = tuple(a + 0.5 * (b - a) for a, b in zip(self.pose, target, strict=True))
            self.alarm, self.servo_on = True, False


@final
class Nx100Standin:
    """One session of the controller: bytes in, bytes out.

    Args:
        robot: whose session it is.
    """

    def __init__(self, robot: RobotState) -> None:
        self.robot = robot
        self.closed = False
        self._buffer = b""
        self._connected = False
        self._pending: tuple[str, int] | None = None
        self._commands: dict[str, Callable[[str], str]] = {
            "RSTATS": self._status,
            "RPOSC": self._position,
            "SVON": self._servo,
            "HOLD": self._hold,
            "MOVL": self._move,
        }

    def feed(self, data: bytes) -> bytes:
        """Take bytes from the host and give what is answered."""
        self._buffer += data
        out = b""
        while not self.closed:
            if self._pending is None:
                line, found, rest = self._buffer.partition(b"\n")
                if not found:
                    return out
                self._buffer = rest
                if not line.strip():
                    continue
                out += self._line(line.strip().decode("ascii", errors="replace"))
            else:
                command, size = self._pending
                if len(self._buffer) < size:
                    return out
                body, self._buffer = self._buffer[:size], self._buffer[size:]
                self._pending = None
                out += self._answer(command, body.decode("ascii", errors="replace").strip())
        return out

    def _line(self, line: str) -> bytes:
        words = line.split()
        if line.startswith("CONNECT Robot_access"):
            if self.robot.refuse_session:
                return self._refuse("Too many sessions")
            self._connected = True
            count = words[-1].rpartition(":")[2] if "Keep-Alive" in line else "1"
            return f"{_BANNER.format(count=count)}\r\n".encode()
        if not self._connected or len(words) != 3 or words[0] != "HOSTCTRL_REQUEST" or not words[2].isdigit():
            return self._refuse("Bad request")
        if words[1] not in self._commands:
            return self._refuse(f"Unknown command {words[1]}")
        accepted = f"OK: {words[1]}\r\n".encode()
        if int(words[2]):
            self._pending = (words[1], int(words[2]))
            return accepted
        return accepted + self._answer(words[1], "")

    def _refuse(self, why: str) -> bytes:
        self.closed = True
        return f"NG: {why}\r\n".encode()

    def _answer(self, command: str, data: str) -> bytes:
        answer = self._commands[command](data)
        if answer.isdigit() and answer != "0000":
            answer = f"ERROR: {command} is not successful({answer})."
        # Answers that carry data end with a carriage return alone.
        return f"{answer}\r".encode() if command.startswith("R") else f"{answer}\r\n".encode()

    def _status(self, _: str) -> str:
        robot = self.robot
        first = 0x80 * robot.remote + 0x40 + 0x08 * robot.running + 0x02
        second = 0x40 * robot.servo_on + 0x10 * robot.alarm + 0x08 * robot.held
        return f"{first},{second}"

    def _position(self, data: str) -> str:
        if len(data.split(",")) != 2:
            return "5180"
        pose = self.robot.now()
        place = ",".join(f"{v:.3f}" for v in pose[:3]) + "," + ",".join(f"{v:.2f}" for v in pose[3:])
        return f"{place},0,0"

    def _servo(self, data: str) -> str:
        if refusal := self._unready(needs_servo=False):
            return refusal
        self.robot.servo_on = data == "1"
        if not self.robot.servo_on:
            self.robot.halt()
        return "0000"

    def _hold(self, data: str) -> str:
        if not self.robot.remote:
            return "2100"
        self.robot.held = data == "1"
        if self.robot.held:
            self.robot.halt()
        return "0000"

    def _move(self, data: str) -> str:
        if refusal := self._unready(needs_servo=True):
            return refusal
        parts = data.split(",")
        if len(parts) != _MOTION_DATA:
            return "5180"
        speed, target = float(parts[1]), tuple(float(part) for part in parts[3:9])
        too_far = any(abs(a - b) > self.robot.reach_mm for a, b in zip(target, _START_POSE, strict=True))
        if too_far or speed <= 0.0:
            return "5200"
        self.robot.begin(target, speed, by_posture=parts[0] == "1")
        return "0000"

    def _unready(self, *, needs_servo: bool) -> str:
        robot = self.robot
        if not robot.remote:
            return "2100"
        if robot.alarm:
            return "2060"
        if robot.running:
            return "2010"
        if needs_servo and not robot.servo_on:
            return "2070"
        return "2080" if needs_servo and robot.held else ""


@final
class InMemoryWire:
    """A wire straight into a stand-in, without a network.

    Args:
        session: the stand-in's session.
    """

    def __init__(self, session: Nx100Standin) -> None:
        self._session = session
        self._out = b""
        self.cut = False

    def send(self, data: bytes) -> None:
        """Hand bytes over."""
        if self.cut or self._session.closed:
            raise ConnectionResetError("connection reset")
        self._out += self._session.feed(data)

    def receive(self, timeout_s: float) -> bytes:
        """The replies so far."""
        out, self._out = self._out, b""
        if not out and not self.cut and not self._session.closed:
            raise TimeoutError(f"nothing within {timeout_s:g} s")
        return b"" if self.cut else out

    def close(self) -> None:
        """Let go."""
        self.cut = True


@final
class Nx100Server:
    """The stand-in at a TCP port, in a thread of its own; a context manager.

    Args:
        robot: whose controller it is.
        host: where to listen.
        port: 0 is any free one.
    """

    def __init__(self, robot: RobotState, host: str = "127.0.0.1", port: int = 0) -> None:
        self._robot = robot
        self._listener = socket.create_server((host, port))
        self._sessions: list[socket.socket] = []
        self._thread = threading.Thread(target=self._serve, name="nx100-standin", daemon=True)

    @property
    def address(self) -> tuple[str, int]:
        """Host and port."""
        host, port = self._listener.getsockname()[:2]
        return str(host), int(port)

    def __enter__(self) -> Nx100Server:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        # An accept that is under way only ends when somebody connects or the socket is shut down.
        with suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        for session in self._sessions:
            with suppress(OSError):
                session.shutdown(socket.SHUT_RDWR)
        self._thread.join()

    def _serve(self) -> None:
        while True:
            try:
                connection, _ = self._listener.accept()
            except OSError:
                return
            self._sessions.append(connection)
            with connection, suppress(OSError):
                session = Nx100Standin(self._robot)
                while not session.closed and (data := connection.recv(4096)):
                    connection.sendall(session.feed(data))
