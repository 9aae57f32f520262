"""A session from its parts to what it came to."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, final

from nxt_twin.diagnose.diagnosis import Diagnosis
from nxt_twin.diagnose.telling.to_json import to_json
from nxt_twin.physics.plant import Plant
from nxt_twin.recording.columns import Port
from nxt_twin.twin.records import Event
from nxt_twin.twin.session import Parts, Session
from nxt_twin.twin.settings import FALSE_ALARMS_PER_HOUR
from nxt_twin.twin.since import Since
from nxt_twin.twin.sinks import Memory, Several
from nxt_twin.twin.verdict import Seen, SessionVerdict, verdict


@final
@dataclass(frozen=True)
class MotorOutcome:
    """How a motor and its model stood at the end.

    Attributes:
        diverging: whether they were apart.
        trouble: what kept the model from being judged; None if nothing did.
    """

    diverging: bool
    trouble: str | None


@final
@dataclass(frozen=True)
class Outcome:
    """The outcome of a session.

    Attributes:
        verdict: in one word and one sentence.
        polls: how many there were.
        stalls: how often the host or the link stood still.
        longest_stall_s: the longest of them, s.
        motors: how each motor stood at the end.
        events: all that was told, in order.
        diagnoses: what was found, in order, with the motor it is about.
        plants: the model of each motor at the end.
    """

    verdict: SessionVerdict
    polls: int
    stalls: int
    longest_stall_s: float
    motors: Mapping[Port, MotorOutcome]
    events: tuple[Event, ...]
    diagnoses: tuple[tuple[Port, Diagnosis], ...]
    plants: Mapping[Port, Plant]

    def document(self) -> dict[str, Any]:
        """The outcome as it stands in JSON (docs/formats.md), without its schema."""
        return {
            "verdict": self.verdict.outcome,
            "sentence": self.verdict.sentence,
            "polls": self.polls,
            "stated_false_alarms_per_hour": FALSE_ALARMS_PER_HOUR,
            "stalls": {"count": self.stalls, "longest_s": self.longest_stall_s},
            "motors": {port: asdict(motor) for port, motor in self.motors.items()},
            "events": [asdict(event) for event in self.events],
            "diagnoses": [{"port": port, **json.loads(to_json(found))} for port, found in self.diagnoses],
        }


@final
class Sitting:
    """One session with a memory of what it told.

    Args:
        parts: what the session is put together from.

    Attributes:
        session: the session itself.
    """

    def __init__(self, parts: Parts) -> None:
        self._memory = Memory()
        self._parts = replace(parts, sink=Several([self._memory, parts.sink]))
        self.session = Session(self._parts)

    def run(self, seconds: float | None) -> None:
        """Hold the session for so long; without an end until interrupted. Call `close` whatever comes of it.

        Raises:
            LinkError: the first link could not be opened, or a lost one cannot ever be again.
            NxtTwinError: the recorder failed.
        """
        self.session.run(seconds)

    def close(self) -> None:
        """Finish what is told and recorded, and wait for no diagnosis."""
        self._parts.sink.close()
        if self._parts.recorder is not None:
            self._parts.recorder.close()
        if self._parts.adopter is not None:
            self._parts.adopter.close()

    def since(self, port: Port, name: str, plant: Plant) -> Since:
        """A motor as the plant of that name was identified, and as this session saw it."""
        return Since(name, port, self._parts.twin.as_run(port, plant), self.session.seen(port))

    def outcome(self) -> Outcome:
        """The outcome so far."""
        session, adopter = self.session, self._parts.adopter
        monitors = session.monitors
        diverging = [port for port, each in monitors.items() if each.diverging]
        events = tuple(self._memory.events)
        return Outcome(
            verdict=verdict(events, diverging, Seen(session.polls, session.lasted_s, session.unseen_s)),
            polls=session.polls,
            stalls=session.stalls.count,
            longest_stall_s=session.stalls.longest_s,
            motors={port: MotorOutcome(each.diverging, each.trouble) for port, each in monitors.items()},
            events=events,
            diagnoses=() if adopter is None else tuple(adopter.diagnoses),
            plants=dict(self._parts.twin.plants),
        )
