"""A recording over a host that stands still now and then, and what a diagnosis says of it.

The brick is the mock in virtual time, and conceals an effect. The program that records it is held up before a request
or after a reply. The stamp of such a row says little of its readings and commands.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from random import Random
from typing import Final, final

from nxt_twin.api.analysis import find_missing_physics
from nxt_twin.api.openers import concealing
from nxt_twin.blind.secret import secret_of
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.errors import LinkLostError, LinkTimeoutError
from nxt_twin.brick.link import Link
from nxt_twin.cli.record import write_down
from nxt_twin.diagnose.diagnosis import Diagnosis
from nxt_twin.diagnose.telling.words import FAULTS
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.start import open_mock_link
from nxt_twin.twin.driver import ProgramDriver, excitation
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.settings import PACES

HIDDEN: Final = "5"
"""The seed at which a stalling host once drew three effects, each with certainty, none of them the truth."""
_EVERY_S: Final = (0.0, 10.0, 3.0, 0.8)
_STALL_S: Final = (0.05, 0.25)
_SURE: Final = 0.95


def report() -> Iterator[str]:
    """A line for each host, from one that never stands still on."""
    hidden = [str(effect["id"]) for effect in secret_of(HIDDEN).effects]
    for every_s in _EVERY_S:
        found = diagnosed(every_s)
        yield f"{_host(every_s)}: {told(found, hidden)}"


def _host(every_s: float) -> str:
    return f"a host that stalls every {every_s:g} s" if every_s else "a host that never stalls"


def told(found: Diagnosis, hidden: Sequence[str]) -> str:
    """Verdict, effects and whether the stalls are named; WRONG where it explains by physics that is not there.

    A fault of the recording, such as stale samples, is there: the stalls make it.
    """
    names = ", ".join(f"{one.id} {one.probability:.2f}" for one in found.effects) or "no effect"
    sure = {one.id for one in found.effects if one.probability >= _SURE}
    others = sure - set(hidden) - FAULTS
    wrong = "; WRONG, and sure" if found.verdict == "explained" and others else ""
    stalls = next((note for note in found.notes if "stood still" in note), "no stall is named")
    return f"{found.verdict}: {names}{wrong}; {stalls}"


def diagnosed(every_s: float, seed: int = 1) -> Diagnosis:
    """Record the concealed brick and diagnose it; 0: no stalls."""
    clock = VirtualClock()

    def opened() -> Brick:
        link = open_mock_link(
            clock, profile="usb", change=concealing(HIDDEN), late=LinkTimeoutError, lost=LinkLostError
        )
        return Brick(_Stalling(link, clock, every_s, Random(seed)) if every_s else link, clock)

    with tempfile.TemporaryDirectory() as folder:
        out, driver = Path(folder) / "run.csv", ProgramDriver(excitation(("a",)))
        plan = Plan(period_s=0.01)
        write_down(
            opened, clock, out, ("a",), plan, pace=PACES["mock"], driver=driver, seconds=driver.duration_s
        )
        found = find_missing_physics(out, "nxt_motor")
    assert isinstance(found, Diagnosis)
    return found


@final
class _Stalling:
    """A link of a program that is held up at random moments."""

    def __init__(self, link: Link, clock: VirtualClock, every_s: float, random: Random) -> None:
        self._link, self._clock, self._every_s, self._random = link, clock, every_s, random
        self._due_s = clock.now_s() + self._next_s()

    def send(self, telegram: bytes) -> None:
        self._hold_up()
        self._link.send(telegram)

    def receive(self, timeout_s: float) -> bytes:
        reply = self._link.receive(timeout_s)
        self._hold_up()
        return reply

    def close(self) -> None:
        self._link.close()

    def describe(self) -> str:
        return self._link.describe()

    def _next_s(self) -> float:
        return self._random.expovariate(1.0 / self._every_s)

    def _hold_up(self) -> None:
        if self._clock.now_s() >= self._due_s:
            self._clock.sleep(self._random.uniform(*_STALL_S))
            self._due_s = self._clock.now_s() + self._next_s()
