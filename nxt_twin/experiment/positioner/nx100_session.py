"""The Ethernet server of Yaskawa's NX100 robot controller, as a client: lines of text over TCP port 80.

A session opens with ``CONNECT Robot_access Keep-Alive:-1``. Each request is then a line with the command and the size
of its data. The controller answers ``OK: COMMAND``, and the client sends the data. The last answer is data, ``0000`` or
an error.
Sources and what is unverified: docs/experiments.md.
"""

from __future__ import annotations

import re
import socket
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Protocol, final

from nxt_twin.experiment.errors import PositionerError

TCP_PORT: Final = 80
_REPLY_TIMEOUT_S: Final = 5.0
_LONGEST_LINE: Final = 4096
_LINE_END: Final = re.compile(rb"\r\n?|\n")
_ERROR: Final = re.compile(r"ERROR:?\s*\[?(?P<command>\w+)\]?.*\((?P<code>\d{4})\)")
_BARE_CODE: Final = re.compile(r"\d{4}")
_DONE: Final = "0000"

ERROR_WORDS: Final[Mapping[int, str]] = MappingProxyType(
    {
        2010: "the robot is moving",
        2060: "an error or alarm is present: clear it at the controller",
        2070: "servo power is off",
        2080: "the controller is in the wrong mode",
        2100: "command remote is not set: turn the key to REMOTE and allow command remote",
        5180: "a wrong number of data",
        5200: "a value is out of range",
    }
)
"""The meaning of the controller's codes, as far as this program uses them."""


class Nx100Wire(Protocol):
    """A connection that carries bytes."""

    def send(self, data: bytes) -> None:
        """Hand bytes over; `OSError` if the connection is gone."""
        ...

    def receive(self, timeout_s: float) -> bytes:
        """Some bytes; empty if the other end has closed. `TimeoutError` if nothing came, else `OSError`."""
        ...

    def close(self) -> None:
        """Let go."""
        ...


@final
class TcpWire:
    """A TCP connection.

    Args:
        host: name or address.
        port: TCP port.

    Raises:
        PositionerError: nobody answers there.
    """

    def __init__(self, host: str, port: int = TCP_PORT) -> None:
        try:
            self._socket = socket.create_connection((host, port), timeout=_REPLY_TIMEOUT_S)
        except OSError as failure:
            raise PositionerError(
                f"cannot be reached: {failure.strerror or failure}",
                where=f"nx100:{host}:{port}",
                mend="check the cable, the address, and that the controller's Ethernet server is on",
            ) from None

    def send(self, data: bytes) -> None:
        """Hand bytes over."""
        self._socket.sendall(data)

    def receive(self, timeout_s: float) -> bytes:
        """Some bytes."""
        self._socket.settimeout(timeout_s)
        return self._socket.recv(_LONGEST_LINE)

    def close(self) -> None:
        """Let go."""
        with suppress(OSError):
            self._socket.close()


@final
@dataclass(frozen=True)
class Nx100Status:
    """What RSTATS tells, as far as it matters here.

    Attributes:
        command_remote: whether the controller takes orders from a host.
        running: whether it is carrying something out.
        servo_on: whether the servos have power.
        error, alarm: whether one is present.
        held: whether motion is on hold, from wherever.
    """

    command_remote: bool
    running: bool
    servo_on: bool
    error: bool
    alarm: bool
    held: bool


def status_of(answer: str) -> Nx100Status:
    """Read the two numbers of RSTATS.

    The first byte: bit 7 is command remote, bit 3 running. The second: bit 6 is servo, 5 error, 4 alarm, 3 to 1 holds.

    """
    first, second = (int(part) for part in answer.split(",")[:2])
    return Nx100Status(
        command_remote=bool(first & 0x80),
        running=bool(first & 0x08),
        servo_on=bool(second & 0x40),
        error=bool(second & 0x20),
        alarm=bool(second & 0x10),
        held=bool(second & 0x0E),
    )


@final
class Nx100Session:
    """One open session; commands in, answers out. Not for several threads at once.

    Args:
        wire: the connection, which is taken over.
        where: what error messages call the controller.

    Raises:
        PositionerError: the controller refuses the session.
    """

    def __init__(self, wire: Nx100Wire, where: str = "nx100") -> None:
        self._wire = wire
        self._where = where
        self._buffer = b""
        self._open = True
        self._answers_owed = 0
        self._data_owed = 0
        try:
            answer = self._exchange(b"CONNECT Robot_access Keep-Alive:-1\r\n")
            if not answer.startswith("OK"):
                what = f"refuses the session: {answer}"
                raise PositionerError(what, where=where, mend="another host may be connected")
        except PositionerError:
            self.close()
            raise

    def status(self) -> Nx100Status:
        """The controller's state.

        Raises:
            PositionerError: it does not answer, or not so.
        """
        answer = self.request("RSTATS")
        try:
            return status_of(answer)
        except ValueError:
            raise PositionerError(f"RSTATS gave '{answer}'", where=self._where) from None

    def position(self) -> tuple[float, ...]:
        """X, Y, Z in mm, Rx, Ry, Rz in degrees, type and tool, in base coordinates.

        Raises:
            PositionerError: it does not answer, or not so.
        """
        answer = self.request("RPOSC", "0,0")
        try:
            values = tuple(float(part) for part in answer.split(","))
        except ValueError:
            values = ()
        if len(values) < 8:
            raise PositionerError(f"RPOSC gave '{answer}'", where=self._where)
        return values

    def request(self, command: str, data: str = "") -> str:
        """Put one request and give its answer.

        Args:
            command: the name, such as RSTATS.
            data: its data without the line's end; empty for none.

        Raises:
            PositionerError: the controller refuses, reports an error, is silent or gone.
        """
        self._settle()
        body = f"{data}\r".encode("ascii") if data else b""
        self._answers_owed, self._data_owed = 2, len(body)
        answer = self._exchange(f"HOSTCTRL_REQUEST {command} {len(body)}\r\n".encode("ascii"))
        self._answers_owed = 1
        if not answer.startswith("OK"):
            self.close()
            raise PositionerError(f"{command} is refused: {answer}", where=self._where)
        self._data_owed = 0
        answer = self._exchange(body)
        self._answers_owed = 0
        if found := _ERROR.search(answer):
            raise self._failure(command, int(found["code"]))
        if _BARE_CODE.fullmatch(answer) and answer != _DONE:
            raise self._failure(command, int(answer))
        return answer

    def close(self) -> None:
        """End the session; closing again does nothing."""
        if self._open:
            self._open = False
            self._wire.close()

    def _settle(self) -> None:
        """End a request that an interrupt cut in two, so that the next one is understood.

        Data that the controller still waits for are sent as blanks, which no command accepts: nothing moves by it.
        """
        if self._answers_owed == 2:
            self._answers_owed = 1
            self._exchange(b"")
        if self._data_owed:
            blanks, self._data_owed = b" " * (self._data_owed - 1) + b"\r", 0
            self._answers_owed = 0
            self._exchange(blanks)
        if self._answers_owed:
            self._answers_owed = 0
            self._exchange(b"")

    def _failure(self, command: str, code: int) -> PositionerError:
        words = ERROR_WORDS.get(code, "see the controller's table of interpreter messages")
        return PositionerError(f"{command} failed with {code}", where=self._where, mend=words)

    def _exchange(self, data: bytes) -> str:
        if not self._open:
            raise PositionerError("the session is closed", where=self._where, mend="connect again")
        try:
            if data:
                self._wire.send(data)
            return self._line()
        except TimeoutError:
            self.close()
            what = f"did not answer within {_REPLY_TIMEOUT_S:g} s"
            raise PositionerError(what, where=self._where, mend="check the controller") from None
        except OSError as failure:
            self.close()
            what = f"the connection is lost: {failure.strerror or failure}"
            raise PositionerError(
                what, where=self._where, mend="check the cable; run it again to go on"
            ) from None

    def _line(self) -> str:
        """The next line that is not empty: an answer ends with CR or CR LF, whose LF may come later."""
        while True:
            end = _LINE_END.search(self._buffer)
            if end is None:
                chunk = self._wire.receive(_REPLY_TIMEOUT_S)
                if not chunk or len(self._buffer) > _LONGEST_LINE:
                    raise ConnectionError("closed by the controller" if not chunk else "endless line")
                self._buffer += chunk
                continue
            line, self._buffer = self._buffer[: end.start()], self._buffer[end.end() :]
            if text := line.decode("ascii", errors="replace").strip(" \0"):
                return text
