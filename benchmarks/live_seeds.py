"""Whether a live session names what a mock brick conceals: `live mock:?conceal=SEED --adopt`, in virtual time.

`python -m benchmarks.live_seeds FIRST LAST` holds a session of 45 s with each of these seeds. It prints the
concealed effect, the time of its notice, the adopted effect, and whether brick and twin agree at the end.

A diagnosis takes five seconds of virtual time. The mock has its own battery and the four sensors that ship
with a brick. Its link is as slow as USB, and the session polls it every 20 ms.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from typing import Any, Final, TypeVar, final

from benchmarks.steps import motor
from nxt_twin.blind.body import hiding
from nxt_twin.blind.secret import concealed
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.errors import LinkLostError, LinkTimeoutError
from nxt_twin.diagnose.diagnosis import Diagnosis
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.start import open_mock_link
from nxt_twin.twin.adopt import Adopter, AtOnce
from nxt_twin.twin.brick_twin import BrickTwin
from nxt_twin.twin.driver import Detour, ProgramDriver, excitation
from nxt_twin.twin.outcome import Outcome, Sitting
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.records import Event
from nxt_twin.twin.session import Parts
from nxt_twin.twin.settings import PACES
from nxt_twin.twin.sinks import Memory

T = TypeVar("T")

SECONDS: Final = 45.0
PERIOD_S: Final = 0.02
DIAGNOSIS_S: Final = 5.0
SURE: Final = 0.8
"""A name with at least this probability is given with confidence."""
_IDS: Final = {effect.name: effect.id for effect in motor().layout.effects}


@final
class _Due(Future[T]):
    """What is known already, and handed out when its time has come."""

    def __init__(self, known: Future[T], clock: VirtualClock) -> None:
        super().__init__()
        self._clock, self._due_s = clock, clock.now_s() + DIAGNOSIS_S
        error = known.exception()
        if error is None:
            self.set_result(known.result())
        else:
            self.set_exception(error)

    def done(self) -> bool:
        """Whether its time has come."""
        return self._clock.now_s() >= self._due_s


@final
class _Beside(Executor):
    """Does each thing at once, and says so five virtual seconds later."""

    def __init__(self, clock: VirtualClock) -> None:
        self._clock = clock

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:  # noqa: ANN401
        """Do it, and hand it out later."""
        return _Due(AtOnce().submit(fn, *args, **kwargs), self._clock)


@final
@dataclass(frozen=True)
class Seen:
    """What became of one session.

    Attributes:
        seed: of what is concealed.
        hidden: the concealed effect, and its size.
        noticed_s: when the first divergence was called, or something was adopted without one; None if never.
        adopted: the names that were taken over, in order; of a re-fit alone none.
        sure: names with confidence that are not the concealed effect's.
        verdict: of the session.
        log: what was said, by the clock.
        cost_s: processor time.
    """

    seed: int
    hidden: tuple[str, str]
    noticed_s: float | None
    adopted: tuple[tuple[str, ...], ...]
    sure: tuple[str, ...]
    verdict: str
    log: tuple[str, ...]
    cost_s: float

    @property
    def names(self) -> set[str]:
        """All that were taken over."""
        return {name for names in self.adopted for name in names}

    @property
    def score(self) -> str:
        """`exact`, `among` others, `missed`."""
        if self.names == {self.hidden[0]}:
            return "exact"
        return "among" if self.hidden[0] in self.names else "missed"

    def line(self) -> str:
        """One row of the table."""
        when = "never" if self.noticed_s is None else f"{self.noticed_s:.1f} s"
        adopted = "; ".join(", ".join(names) or "re-fit" for names in self.adopted) or "nothing"
        wrong = f"  WRONG, sure: {', '.join(self.sure)}" if self.sure else ""
        return (
            f"{self.seed}  {' '.join(self.hidden):32} noticed {when:>7}  adopted: {adopted} ({self.score})  "
            f"{self.verdict}{wrong}  [{self.cost_s:.0f} s]"
        )


def seen(seed: int) -> Seen:
    """One session in virtual time."""
    began_s, clock = time.process_time(), VirtualClock()
    secret = concealed(seed)
    link = open_mock_link(
        clock, profile="usb", change=hiding(secret), late=LinkTimeoutError, lost=LinkLostError
    )
    driver = Detour(ProgramDriver(excitation(("a",))))
    sitting = Sitting(
        Parts(
            open_brick=lambda: Brick(link, clock),
            clock=clock,
            twin=BrickTwin({"a": motor()}),
            sink=Memory(),
            plan=Plan({1: "touch", 2: "sound", 3: "light", 4: "ultrasonic"}, period_s=PERIOD_S),
            pace=PACES["mock"],
            driver=driver,
            adopter=Adopter(_Beside(clock), experimenting=True),
            experiment=driver.run,
        )
    )
    sitting.run(SECONDS)
    effect = secret.effects[0]
    hidden = str(effect["id"]), str(effect["size"])
    return _judged(seed, hidden, sitting.outcome(), time.process_time() - began_s)


def _judged(seed: int, hidden: tuple[str, str], outcome: Outcome, cost_s: float) -> Seen:
    noticed = next((event for event in outcome.events if event.kind in ("divergence", "adopted")), None)
    adopted = [event for event in outcome.events if event.kind == "adopted"]
    return Seen(
        seed=seed,
        hidden=hidden,
        noticed_s=None if noticed is None else noticed.time_s,
        adopted=tuple(tuple(_IDS[name] for name in event.effects) for event in adopted),
        sure=_sure(hidden[0], adopted, [found for _, found in outcome.diagnoses]),
        verdict=outcome.verdict.outcome,
        log=(
            *(f"{event.time_s:6.1f} s  {event.words}" for event in outcome.events),
            outcome.verdict.sentence,
        ),
        cost_s=cost_s,
    )


def _sure(hidden: str, adopted: Sequence[Event], diagnoses: Sequence[Diagnosis]) -> tuple[str, ...]:
    """Names that were taken over though nothing of the kind is there, without a word of doubt."""
    names = {_IDS[name] for event in adopted for name in event.effects} - {hidden}
    said = [effect for found in diagnoses for effect in found.effects if effect.id in names]
    doubted = {each.id for each in said if hidden in {other.id for other in each.confusable_with}}
    return tuple(sorted({each.id for each in said if each.probability >= SURE} - doubted))


def table(seeds: Iterable[int], *, logs: bool = False) -> Iterator[str]:
    """A row for each seed, then how many came out."""
    found = []
    for seed in seeds:
        found.append(seen(seed))
        yield found[-1].line()
        if logs:
            yield from (f"        {line}" for line in found[-1].log)
    yield _sums(found)


def _sums(found: Sequence[Seen]) -> str:
    exact = sum(each.score == "exact" for each in found)
    named = sum(each.score != "missed" for each in found)
    together = sum(each.score != "missed" and each.verdict == "explained" for each in found)
    noticed = sum(each.noticed_s is not None for each in found)
    wrong = sum(bool(each.sure) for each in found)
    return (
        f"of {len(found)}: noticed {noticed}, named {named} (alone {exact}), of those together at the end {together}; "
        f"wrong names with confidence in {wrong}"
    )


if __name__ == "__main__":
    first, last = map(int, sys.argv[1:3])
    for line in table(range(first, last + 1), logs="--log" in sys.argv):
        print(line, flush=True)
