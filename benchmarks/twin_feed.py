"""A live twin fed with a motor of the benchmark's own simulator, over a link that hides when the brick acts."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final, final

import numpy as np
from numpy.random import Generator

from nxt_twin.blind.case import ConcealedCase
from nxt_twin.blind.polling import LinkName
from nxt_twin.mock.serve.profile import PROFILES, Profile
from nxt_twin.physics.plant import Plant, plant_from_config
from nxt_twin.recording.columns import DRIVE_MODES, Port
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.recording import Recording
from nxt_twin.twin.brick_twin import BrickTwin, TwinOptions
from nxt_twin.twin.bridge import plain_bridge
from nxt_twin.twin.monitor import MotorMonitor
from nxt_twin.twin.motor import ReadingEvidence
from nxt_twin.twin.records import Event
from nxt_twin.twin.settings import PACES, Pace

_PACE: Final[dict[LinkName, Pace]] = {"usb": PACES["usb"], "bluetooth": PACES["bt"]}
_TICK_S: Final = 1e-3
Heed = Callable[[ReadingEvidence], None]


@final
@dataclass
class Fed:
    """What became of it.

    Attributes:
        events: what the monitor said.
        most_nats: the most evidence that ever came together.
        least_nothing: the least probability that the model ever had among what is weighed.
        squares: normalised squared innovations.
        effects: probabilities at the end.
    """

    events: list[Event] = field(default_factory=list)
    most_nats: float = 0.0
    least_nothing: float = 1.0
    squares: list[float] = field(default_factory=list)
    effects: dict[str, float] = field(default_factory=dict)

    def of(self, kind: str) -> list[Event]:
        """The events of one kind."""
        return [event for event in self.events if event.kind == kind]


@final
class Trips:
    """Draws round trips as the mock's link makes them, and what a session makes of their stamps.

    Args:
        rng: of the delays.
        link: which.
    """

    def __init__(self, rng: Generator, link: LinkName) -> None:
        self._rng = rng
        self._profile: Profile = PROFILES[link]
        self._pace = _PACE[link]

    def draw(self, lag_s: float = 0.0) -> tuple[float, float, float]:
        """By how much a stamp is off, its standard deviation as the session has it, and the whole round trip, s.

        Args:
            lag_s: up to how much later than its being taken up a command acts.
        """
        profile = self._profile
        jitter_up, jitter_down, tick, lag = self._rng.random(4)
        up_s = 1e-3 * (profile.to_brick_ms + jitter_up * profile.jitter_ms) + _TICK_S * tick
        down_s = 1e-3 * (profile.to_host_ms + profile.turnaround_ms + jitter_down * profile.jitter_ms)
        trip_s = up_s + down_s
        off_s = self._pace.share * trip_s - up_s - lag_s * (lag - 0.5)
        return off_s, self._pace.share_std * trip_s, trip_s


def true_plant(case: ConcealedCase) -> Plant:
    """The motor of a case as it is, without what is concealed in it."""
    return plant_of(case.answer["base"])


def plant_of(base: Mapping[str, float]) -> Plant:
    """The plant of a true motor's numbers, by a plant file's keys."""
    keys = load_plant_config("nxt_motor").keys() & base.keys()
    return plant_from_config({**{key: base[key] for key in keys}, "kind": "dc_motor"}, "power_pct")


def feed(
    recording: Recording,
    plant: Plant,
    link: LinkName,
    seed: int,
    options: TwinOptions | None = None,
    heed: Heed = lambda _: None,
) -> Fed:
    """Hand a recording with true stamps to a twin and its monitor, as one motor alone is polled over a link.

    `heed` is told what each reading says.
    """
    return feed_all({"a": recording}, {"a": plant}, link, seed, options, heed)["a"]


def feed_all(
    recordings: Mapping[Port, Recording],
    plants: Mapping[Port, Plant],
    link: LinkName,
    seed: int,
    options: TwinOptions | None = None,
    heed: Heed = lambda _: None,
    *,
    sensors: bool = False,
) -> dict[Port, Fed]:
    """The same of several motors on one battery, polled in turn; with `sensors`, one is read in each poll as well.

    Each recording has the columns of port a, whichever motor it is of.
    """
    trips = Trips(np.random.default_rng(seed), link)
    options = options or TwinOptions(bridge=plain_bridge, cells_ohm=0.0)
    began_s = min(float(recording.time_s[0]) for recording in recordings.values())
    twin = BrickTwin(plants, options, now_s=began_s)
    watched = {port: _Watched(port, twin, heed) for port in recordings}
    for time_s, port, row, polled in _rows(recordings, trips, sensors=sensors):
        columns = recordings[port].columns
        if np.isfinite(columns["battery_v"][row]):
            twin.read_battery(float(columns["battery_v"][row]))
        if polled:
            off_s, std_s, _ = trips.draw()
            watched[port].read(time_s, time_s + off_s, std_s, int(columns["a_tacho_deg"][row]))
        off_s, std_s, _ = trips.draw(_TICK_S)
        mode = DRIVE_MODES[_mode(recordings[port], row)]
        twin.command(port, int(columns["a_power_pct"][row]), mode, time_s + off_s, std_s)
    return {port: each.fed for port, each in watched.items()}


@final
class _Watched:
    """One motor of a twin, its monitor, and what became of it."""

    def __init__(self, port: Port, twin: BrickTwin, heed: Heed) -> None:
        self._port = port
        self._twin = twin
        self._monitor = MotorMonitor(port, twin.options.watch)
        self._heed = heed
        self._nats = 0.0
        self.fed = Fed()

    def read(self, time_s: float, taken_s: float, taken_std_s: float, count: int) -> None:
        """Hand on a count."""
        evidence = self._twin.read_tacho(self._port, taken_s, count, taken_std_s)
        effects, fed = self._twin.motor(self._port).probabilities, self.fed
        self._nats = max(0.0, self._nats + evidence.nats)
        fed.most_nats = max(fed.most_nats, self._nats)
        fed.least_nothing = min(fed.least_nothing, effects.get("nothing", 1.0))
        self._heed(evidence)
        fed.squares.append(evidence.innovation.normalised_square)
        fed.effects = effects
        told, _ = self._twin.commanded(self._port)
        for event in self._monitor.take(time_s, evidence, told, effects):
            fed.events.append(event)
            if event.kind == "divergence":
                self._nats = 0.0
                self._twin.forget_evidence(self._port)


def _rows(
    recordings: Mapping[Port, Recording], trips: Trips, *, sensors: bool
) -> Iterator[tuple[float, Port, int, bool]]:
    """Each row's time, motor and number, and whether the link is free again and it is that motor's turn."""
    merged = sorted(
        (time_s, port, row)
        for port, recording in recordings.items()
        for row, time_s in enumerate(recording.time_s.tolist())
    )
    turns = itertools.cycle(recordings)
    turn, last = next(turns), list(recordings)[-1]
    free_s = -1.0
    for time_s, port, row in merged:
        polled = port == turn and time_s >= free_s
        if polled:
            free_s = time_s + trips.draw()[2]
            if sensors and port == last:
                free_s += trips.draw()[2]
            turn = next(turns)
        yield time_s, port, row, polled


def _mode(recording: Recording, row: int) -> int:
    modes = recording.columns.get("a_mode")
    return 0 if modes is None else int(modes[row])
