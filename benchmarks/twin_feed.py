"""A live twin fed with a motor of the benchmark's own simulator, over a link that hides when the brick acts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final, final

import numpy as np
from numpy.random import Generator

from nxt_twin.blind.case import ConcealedCase
from nxt_twin.blind.polling import Link
from nxt_twin.mock.serve.profile import PROFILES, Profile
from nxt_twin.physics.plant import Plant, plant_from_config
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.recording import DRIVE_MODES, Recording
from nxt_twin.twin.brick_twin import BrickTwin, TwinOptions
from nxt_twin.twin.bridge import plain_bridge
from nxt_twin.twin.monitor import MotorMonitor
from nxt_twin.twin.records import Event
from nxt_twin.twin.settings import PACES, Pace

_PACE: Final[dict[Link, Pace]] = {"usb": PACES["usb"], "bluetooth": PACES["bt"]}
_TICK_S: Final = 1e-3


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

    def __init__(self, rng: Generator, link: Link) -> None:
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
    base = case.answer["base"]
    keys = load_plant_config("nxt_motor").keys() & base.keys()
    return plant_from_config({**{key: base[key] for key in keys}, "kind": "dc_motor"}, "power_pct")


def feed(
    recording: Recording, plant: Plant, link: Link, seed: int, options: TwinOptions | None = None
) -> Fed:
    """Hand a recording with true stamps to a twin and its monitor, as one motor alone is polled over a link."""
    columns, trips = recording.columns, Trips(np.random.default_rng(seed), link)
    options = options or TwinOptions(bridge=plain_bridge, cells_ohm=0.0)
    twin = BrickTwin({"a": plant}, options, now_s=float(recording.time_s[0]))
    monitor, fed, nats = MotorMonitor("a", options.watch), Fed(), 0.0
    for row, time_s, polled in _rows(recording, trips):
        if np.isfinite(columns["battery_v"][row]):
            twin.read_battery(float(columns["battery_v"][row]))
        power, mode = int(columns["a_power_pct"][row]), _mode(recording, row)
        if polled:
            off_s, std_s, _ = trips.draw()
            evidence = twin.read_tacho("a", time_s + off_s, int(columns["a_tacho_deg"][row]), std_s)
            effects = twin.motor("a").probabilities
            nats = max(0.0, nats + evidence.nats)
            fed.most_nats = max(fed.most_nats, nats)
            fed.least_nothing = min(fed.least_nothing, effects.get("nothing", 1.0))
            fed.squares.append(evidence.innovation.normalised_square)
            fed.effects = effects
            told, _ = twin.commanded("a")
            for event in monitor.take(time_s, evidence, told, effects):
                fed.events.append(event)
                if event.kind == "divergence":
                    nats = 0.0
                    twin.forget_evidence("a")
        off_s, std_s, _ = trips.draw(_TICK_S)
        twin.command("a", power, DRIVE_MODES[mode], time_s + off_s, std_s)
    return fed


def _rows(recording: Recording, trips: Trips) -> Iterator[tuple[int, float, bool]]:
    """Each row and its time, and whether the link is free again to read a count in it."""
    free_s = -1.0
    for row, time_s in enumerate(recording.time_s.tolist()):
        polled = time_s >= free_s
        if polled:
            free_s = time_s + trips.draw()[2]
        yield row, time_s, polled


def _mode(recording: Recording, row: int) -> int:
    modes = recording.columns.get("a_mode")
    return 0 if modes is None else int(modes[row])
