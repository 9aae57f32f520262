"""The messages of a live twin to its sinks: one `Tick` a poll, and an `Event` for a sentence."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal, Protocol, final

from nxt_twin.recording.columns import DriveMode, Port

EventKind = Literal[
    "started",
    "divergence",
    "calm",
    "stall",
    "slip",
    "disconnected",
    "low_battery",
    "link_lost",
    "link_back",
    "effect_named",
    "adopted",
    "undiagnosed",
    "gathering",
    "stalled",
    "stopped",
]


@final
@dataclass(frozen=True)
class Innovation:
    """One reading beside what was predicted of it.

    Attributes:
        time_s: when the reading arrived, s since the session began.
        channel: the recording's column, such as `a_tacho_deg` or `s4_ultrasonic_cm`.
        unit: of the four numbers that follow (variance: its square).
        measured: the reading.
        predicted: what the filter expected before it saw it.
        variance: that the difference was expected to have.
        accepted: whether the filter believed the reading.
    """

    time_s: float
    channel: str
    unit: str
    measured: float
    predicted: float
    variance: float
    accepted: bool = True

    @property
    def innovation(self) -> float:
        """Measured less predicted."""
        return self.measured - self.predicted

    @property
    def normalised_square(self) -> float:
        """The innovation's square over its variance: about 1 on average while the model holds."""
        return self.innovation**2 / self.variance


@final
@dataclass(frozen=True)
class MotorBelief:
    """The twin's estimate of one motor after an update.

    Attributes:
        port: of the brick.
        power_pct: duty in force.
        mode: drive mode in force.
        angle_deg: estimate of the hub's angle.
        speed_deg_per_s: of its speed.
        current_a: of the winding's current.
        unknown_torque_nm: of a torque that the model does not have.
        unknown_torque_std_nm: its standard deviation.
        effects: probability of each candidate explanation, `nothing` for the model as it is; sums to 1; empty
            where none are weighed.
    """

    port: Port
    power_pct: float
    mode: DriveMode
    angle_deg: float
    speed_deg_per_s: float
    current_a: float
    unknown_torque_nm: float
    unknown_torque_std_nm: float
    effects: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))


@final
@dataclass(frozen=True)
class Tick:
    """One poll of the brick and what became of it.

    Attributes:
        number: of the poll, from 0.
        sent_s: when the first request of the poll was sent, s since the session began.
        received_s: when the last reply arrived.
        motors: the motors that are watched; while the link is lost, as the model alone has them.
        innovations: one for each reading of this poll.
        battery_v: the battery's voltage, where it was read in this poll.
        link_up: whether the brick answered.
    """

    number: int
    sent_s: float
    received_s: float
    motors: tuple[MotorBelief, ...]
    innovations: tuple[Innovation, ...]
    battery_v: float | None = None
    link_up: bool = True


@final
@dataclass(frozen=True)
class Event:
    """Something to be said in words.

    Attributes:
        time_s: when it was noticed, s since the session began.
        kind: what it is.
        words: one sentence for a person.
        port: the motor's, where it is about one.
        channel: the reading's, where it is about one.
        onset_s: since when, where that can be said.
        strength: in nats or normalised units, as `words` says.
        effects: names of those that were taken over.
        instead: whether they are in the place of all that were taken over before.
    """

    time_s: float
    kind: EventKind
    words: str
    port: Port | None = None
    channel: str | None = None
    onset_s: float | None = None
    strength: float | None = None
    effects: tuple[str, ...] = ()
    instead: bool = False


class Sink(Protocol):
    """Something that is told of a session; it must neither block nor raise."""

    def tick(self, tick: Tick) -> None:
        """Take one poll."""
        ...

    def event(self, event: Event) -> None:
        """Take one event."""
        ...

    def close(self) -> None:
        """The session is over; finish within a second or two."""
        ...
