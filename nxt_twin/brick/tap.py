"""Records every telegram of a link, with its stamp, into a file that can be replayed.

The file has one JSON object a line: first ``{"schema": "nxt-twin/tap/1", "link": …}``, then
``{"at_s": …, "way": "out" | "in", "hex": …}``, or ``{"at_s": …, "way": "none", "error": …}`` where a
telegram was waited for in vain.
"""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Final, TextIO, final

from nxt_twin.brick.clock import Clock
from nxt_twin.brick.errors import (
    BrickError,
    GarbageError,
    HalfTelegramError,
    LinkError,
    LinkLostError,
    LinkTimeoutError,
)
from nxt_twin.brick.link import Link

SCHEMA: Final = "nxt-twin/tap/1"

_ERRORS: Final = {
    kind.__name__: kind for kind in (LinkTimeoutError, HalfTelegramError, GarbageError, LinkLostError)
}


class Way(StrEnum):
    """Where a telegram went."""

    OUT = "out"
    IN = "in"
    NONE = "none"


@final
@dataclass(frozen=True)
class TapEvent:
    """One line of a tap.

    Attributes:
        at_s: the clock, s, when it was handed to the link or came from it.
        way: out to the brick, in from it, or none.
        hex: the telegram's bytes, as hexadecimal digits.
        error: the class of the link's error, where none came.
    """

    at_s: float
    way: Way
    hex: str = ""
    error: str = ""


@final
@dataclass(frozen=True)
class Tap:
    """The recording of a tap.

    Attributes:
        link: what the link called itself.
        events: in the order of time.
    """

    link: str
    events: tuple[TapEvent, ...]


@final
class TappedLink:
    """A link that is written down.

    Args:
        link: the link, which is taken over.
        clock: stamps each telegram.
        sink: where the lines go; every line is flushed, so that a crash loses nothing. The caller closes it.
    """

    def __init__(self, link: Link, clock: Clock, sink: TextIO) -> None:
        self._link = link
        self._clock = clock
        self._sink = sink
        self._write({"schema": SCHEMA, "link": link.describe()})

    def send(self, telegram: bytes) -> None:
        """Hand one telegram over; errors as with `Link`."""
        self._note(TapEvent(self._clock.now_s(), Way.OUT, telegram.hex()))
        self._link.send(telegram)

    def receive(self, timeout_s: float) -> bytes:
        """Wait for one telegram; errors as with `Link`."""
        try:
            telegram = self._link.receive(timeout_s)
        except LinkError as error:
            self._note(TapEvent(self._clock.now_s(), Way.NONE, error=type(error).__name__))
            raise
        self._note(TapEvent(self._clock.now_s(), Way.IN, telegram.hex()))
        return telegram

    def close(self) -> None:
        """Close the link, not the file."""
        self._link.close()

    def describe(self) -> str:
        """The link's own description."""
        return self._link.describe()

    def _note(self, event: TapEvent) -> None:
        self._write({key: value for key, value in asdict(event).items() if value != ""})

    def _write(self, line: dict[str, object]) -> None:
        self._sink.write(json.dumps(line) + "\n")
        self._sink.flush()


@final
class ReplayLink:
    """A link that answers as a recorded one did, to the same requests in the same order.

    Args:
        tap: what was recorded.
    """

    def __init__(self, tap: Tap) -> None:
        self._link = tap.link
        self._left = deque(tap.events)

    def send(self, telegram: bytes) -> None:
        """Take one telegram.

        Raises:
            BrickError: the recording goes on otherwise.
            LinkLostError: the recording is at its end.
        """
        event = self._next()
        if event.way is not Way.OUT or event.hex != telegram.hex():
            raise BrickError(
                f"the recording goes on with {event.way} {event.hex or event.error}, not {telegram.hex()}",
                where=self.describe(),
                mend="replay the program that was recorded",
            )

    def receive(self, timeout_s: float) -> bytes:
        """Give the next telegram that came, or the error that did; waits for nothing.

        Raises:
            BrickError: the recording goes on otherwise.
            LinkLostError: the recording is at its end.
        """
        del timeout_s
        event = self._next()
        if event.way is Way.OUT:
            raise BrickError(
                "the recording goes on with a request", where=self.describe(), mend="replay what was recorded"
            )
        if event.way is Way.NONE:
            raise _ERRORS.get(event.error, LinkLostError)("as recorded", where=self.describe())
        return bytes.fromhex(event.hex)

    def close(self) -> None:
        """Forget the rest."""
        self._left.clear()

    def describe(self) -> str:
        """The recording."""
        return f"replay of {self._link}"

    def _next(self) -> TapEvent:
        if not self._left:
            raise LinkLostError("the recording is at its end", where=self.describe())
        return self._left.popleft()


def read_tap(lines: Iterable[str]) -> Tap:
    """The recording of a tap; a last line that a crash cut off is left out.

    Args:
        lines: the file's lines.

    Raises:
        BrickError: they are not a tap's.
    """
    header, *rest = list(lines) or [""]
    try:
        opening = json.loads(header)
        if opening["schema"] != SCHEMA:
            raise ValueError(opening["schema"])
        complete = [line for line in rest if line.endswith("\n")]
        events = tuple(_event(json.loads(line)) for line in complete)
        return Tap(str(opening["link"]), events)
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise BrickError(f"is not a tap's file ({SCHEMA}): {error}") from error


def _event(line: dict[str, object]) -> TapEvent:
    event = TapEvent(
        at_s=float(str(line["at_s"])),
        way=Way(str(line["way"])),
        hex=str(line.get("hex", "")),
        error=str(line.get("error", "")),
    )
    bytes.fromhex(event.hex)
    return event
