"""The verdict of a session, in one line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, final

from nxt_twin.physics.effects.stop import END_STOP
from nxt_twin.recording.columns import Port
from nxt_twin.twin.records import Event

VerdictWord = Literal["holds", "passed", "explained", "diverges", "trouble", "unseen"]

_TROUBLES = ("stall", "disconnected")
_ENOUGH = 0.5
_NEARLY_ALL = 0.95


@final
@dataclass(frozen=True)
class Seen:
    """How much of a session there was to see.

    Attributes:
        polls: that were answered.
        lasted_s: from when the brick was reached to the end.
        unseen_s: of which the link was lost.
    """

    polls: int
    lasted_s: float
    unseen_s: float

    @property
    def share(self) -> float:
        """Of the session, in which the brick could be seen."""
        if not self.polls:
            return 0.0
        return 1.0 - self.unseen_s / self.lasted_s if self.lasted_s else 1.0

    @property
    def loss(self) -> str:
        """For how long it was not, in words."""
        return f"the link was lost for {self.unseen_s:.1f} of {self.lasted_s:.1f} s"


@final
@dataclass(frozen=True)
class SessionVerdict:
    """How model and brick got on.

    Attributes:
        outcome: `holds`: never apart; `passed`: apart for a while, and together again with the same model;
            `explained`: together again with what a diagnosis found; `diverges`: apart at the end; `trouble`: a
            motor was blocked or not there, so that nothing could be said of its model; `unseen`: nothing was noticed,
            but for most of the session there was nothing to see.
        sentence: the same for a person.
    """

    outcome: VerdictWord
    sentence: str


def verdict(events: Sequence[Event], diverging: Sequence[Port], seen: Seen) -> SessionVerdict:
    """The verdict on a session, by its events, the motors that are off their models at its end, and what was seen."""
    adopted = [event for event in events if event.kind == "adopted"]
    apart = [event for event in events if event.kind == "divergence"]
    stopped = {event.port for event in adopted if END_STOP.name in event.effects}
    troubles = [event for event in events if event.kind in _TROUBLES and event.port not in stopped]
    if diverging:
        last = next(event for event in reversed(apart) if event.port in diverging)
        return SessionVerdict("diverges", f"brick and model diverge; {last.words}")
    if troubles:
        return SessionVerdict("trouble", troubles[0].words)
    if adopted:
        return SessionVerdict("explained", f"brick and model agree again; {_adopted(adopted)}")
    if apart:
        return SessionVerdict("passed", f"brick and model diverged for a while; {apart[0].words}")
    return _undisturbed(seen)


def _undisturbed(seen: Seen) -> SessionVerdict:
    if not seen.polls:
        return SessionVerdict(
            "unseen", "the brick answered no poll, so this session does not judge the model"
        )
    if seen.share < _ENOUGH:
        return SessionVerdict("unseen", f"{seen.loss}, so this session does not judge the model")
    if seen.share < _NEARLY_ALL:
        return SessionVerdict("holds", f"the model holds wherever the brick answered; {seen.loss}")
    return SessionVerdict("holds", "the model holds: the monitor found no divergence")


def _adopted(adopted: Sequence[Event]) -> str:
    """Every effect that was taken over, motor by motor; of a motor without any, what was said of it last."""
    ports = dict.fromkeys(event.port for event in adopted)
    return "; ".join(_adopted_by([event for event in adopted if event.port == port]) for port in ports)


def _adopted_by(adopted: Sequence[Event]) -> str:
    last = adopted[-1]
    names: dict[str, None] = {}
    for event in adopted:
        names = ({} if event.instead else names) | dict.fromkeys(event.effects)
    if set(last.effects) == set(names):
        return last.words
    refitted = "" if last.effects else ", with its parameters re-fitted later"
    return f"port {(last.port or '').upper()}: the model now has {', '.join(names)}{refitted}"
