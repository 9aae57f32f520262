"""What a session comes to, in one line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, final

from nxt_twin.recording.columns import Port
from nxt_twin.twin.records import Event

Outcome = Literal["holds", "passed", "explained", "diverges", "trouble"]

_TROUBLES = ("stall", "disconnected")


@final
@dataclass(frozen=True)
class Verdict:
    """How model and brick got on.

    Attributes:
        outcome: `holds`: never apart; `passed`: apart for a while, and together again with the same model;
            `explained`: together again with what a diagnosis found; `diverges`: apart at the end; `trouble`: a
            motor was blocked or not there, so that nothing could be said of its model.
        sentence: the same for a person.
    """

    outcome: Outcome
    sentence: str


def verdict(events: Sequence[Event], diverging: Sequence[Port]) -> Verdict:
    """The verdict on a session, by its events and the motors that are off their models at its end."""
    adopted = [event for event in events if event.kind == "adopted"]
    apart = [event for event in events if event.kind == "divergence"]
    troubles = [event for event in events if event.kind in _TROUBLES]
    if diverging:
        last = next(event for event in reversed(apart) if event.port in diverging)
        return Verdict("diverges", f"model and brick are apart: {last.words}")
    if troubles:
        return Verdict("trouble", troubles[0].words)
    if adopted:
        return Verdict("explained", f"model and brick are together again: {adopted[-1].words}")
    if apart:
        return Verdict("passed", f"model and brick were apart for a while: {apart[0].words}")
    return Verdict("holds", "the model holds: nothing was seen that it does not explain")
