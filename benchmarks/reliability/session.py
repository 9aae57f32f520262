"""Hours of `live` in virtual time over a Bluetooth link with faults: memory, alarms, and motors that coast at the end.

Faults: one reply in 500 is lost. Once in 500 replies the host stands still for up to half a second. Six times
an hour the link is gone for some seconds. The brick is the mock, its motors are those of their models.
"""

from __future__ import annotations

import gc
import os
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import Final, final

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.errors import LinkLostError, LinkRefusedError, LinkTimeoutError, Refusal
from nxt_twin.brick.portrait import driven
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.link import MockLink
from nxt_twin.mock.serve.profile import PROFILES
from nxt_twin.mock.start import switch_on
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.columns import PORTS
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.files import read_recording
from nxt_twin.recording.stream import RecordingWriter
from nxt_twin.twin.brick_twin import BrickTwin
from nxt_twin.twin.driver import ProgramDriver, excitation
from nxt_twin.twin.logbook import columns_to_fill
from nxt_twin.twin.outcome import Sitting
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.records import Event, Tick
from nxt_twin.twin.session import Parts
from nxt_twin.twin.settings import PACES

_SENSORS: Final = {1: "touch", 2: "sound", 3: "light", 4: "ultrasonic"}
_LOOK_S: Final = 300.0
_SETTLED_S: Final = 1200.0
"""Caches are warm by then; a motor's history, of 12 000 counts at most, is full after about an hour."""
_CUTS_PER_H: Final = 6
_CHANCE: Final = 1.0 / 500.0
_MB: Final = 2**20


def report(hours: float, seed: int) -> Iterator[str]:
    """What became of a session of a number of hours."""
    rig, watcher = _Rig(hours, seed), _Watcher()
    plant = plant_from_config(load_plant_config("nxt_motor"), "power_pct")
    began_s = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "session.parquet"
        parts = Parts(
            open_brick=rig.open, clock=rig.clock, twin=BrickTwin(dict.fromkeys(PORTS, plant)), sink=watcher,
            plan=Plan(sensors=_SENSORS), pace=PACES["bt"], driver=ProgramDriver(excitation(PORTS)),  # type: ignore[arg-type]
            recorder=RecordingWriter(out, columns_to_fill(PORTS, _SENSORS)),  # type: ignore[arg-type]
        )  # fmt: skip
        sitting = Sitting(parts)
        sitting.run(3600.0 * hours)
        sitting.close()
        rows = read_recording(out).rows
    outcome = sitting.outcome()
    kinds = [event.kind for event in outcome.events]
    with Brick(MockLink(rig.host), rig.clock) as brick:
        turning = driven(brick)
    yield (
        f"live, {hours:g} h of virtual time in {time.monotonic() - began_s:.0f} s: {outcome.polls} polls, {rows} rows, "
        f"{kinds.count('link_lost')} links lost and {kinds.count('link_back')} back, {rig.lost} replies lost, "
        f"{outcome.stalls} stalls"
    )
    alarms = kinds.count("divergence")
    yield f"alarms on a brick that is as its model says: {alarms}; verdict: {outcome.verdict.sentence}"
    yield f"memory, MB, every {_LOOK_S / 60:.0f} min: {' '.join(f'{each:.0f}' for each in watcher.resident_mb)}"
    settled = watcher.resident_mb[int(_SETTLED_S / _LOOK_S) :]
    if len(settled) > 1:
        yield f"of which after {_SETTLED_S / 60:.0f} min: {settled[-1] - settled[0]:+.1f} MB"
    yield f"motors driven after it: {turning or 'none, all coast'}"


@final
class _Watcher:
    """Looks at the process's memory now and then."""

    def __init__(self) -> None:
        self.resident_mb: list[float] = []
        self._due_s = 0.0

    def tick(self, tick: Tick) -> None:
        if tick.received_s >= self._due_s:
            self._due_s += _LOOK_S
            gc.collect()
            pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
            self.resident_mb.append(pages * os.sysconf("SC_PAGE_SIZE") / _MB)

    def event(self, event: Event) -> None:
        """Nothing: the session's own memory keeps them."""

    def close(self) -> None:
        """Nothing to finish."""


@final
class _Rig:
    """A mock brick in virtual time, and when its link fails."""

    def __init__(self, hours: float, seed: int) -> None:
        self.clock = VirtualClock()
        self.host = Host(switch_on(), self.clock)
        self.random = Random(seed)
        self.lost = 0
        starts = sorted(self.random.uniform(60.0, 3600.0 * hours) for _ in range(round(_CUTS_PER_H * hours)))
        self._cuts = [(low, low + self.random.uniform(3.0, 10.0)) for low in starts]

    def is_cut(self) -> bool:
        return any(low <= self.clock.now_s() < high for low, high in self._cuts)

    def open(self) -> Brick:
        if self.is_cut():
            raise LinkRefusedError("out of reach", cause=Refusal.UNREACHABLE)
        return Brick(_Faulty(self), self.clock)


@final
class _Faulty:
    """A link that fails as its rig says."""

    def __init__(self, rig: _Rig) -> None:
        self._rig = rig
        profile = PROFILES["bluetooth"]
        self._link = MockLink(
            rig.host, profile, seed=rig.random.randrange(1000), late=LinkTimeoutError, lost=LinkLostError
        )

    def send(self, telegram: bytes) -> None:
        if self._rig.is_cut():
            raise LinkLostError("out of reach")
        self._link.send(telegram)

    def receive(self, timeout_s: float) -> bytes:
        reply = self._link.receive(timeout_s)
        chance = self._rig.random.random()
        if chance < _CHANCE:
            self._rig.lost += 1
            self._rig.clock.sleep(timeout_s)
            raise LinkTimeoutError("the reply was lost")
        if chance < 2.0 * _CHANCE:
            self._rig.clock.sleep(self._rig.random.uniform(0.03, 0.5))
        return reply

    def close(self) -> None:
        self._link.close()

    def describe(self) -> str:
        return self._link.describe()
