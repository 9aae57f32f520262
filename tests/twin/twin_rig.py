"""A session on a mock brick, in virtual time."""

from typing import NamedTuple

import numpy as np
import yaml
from twin_feed import nxt_motor

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.errors import LinkLostError, LinkRefusedError, LinkTimeoutError, Refusal
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.link import MockLink
from nxt_twin.mock.serve.profile import PROFILES
from nxt_twin.mock.start import switch_on
from nxt_twin.recording.program import MotorProgram
from nxt_twin.twin.brick_twin import BrickTwin, TwinOptions
from nxt_twin.twin.driver import ProgramDriver, excitation
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.session import Parts, Session
from nxt_twin.twin.settings import PACES
from nxt_twin.twin.sinks import Memory, Several

EVERY_SENSOR = {1: "touch", 2: "sound", 3: "light", 4: "ultrasonic"}


class CuttableLink:
    """A mock's link that can be cut while it is used."""

    def __init__(self, rig):
        self._rig = rig
        self._link = MockLink(
            rig.host, PROFILES[rig.profile], seed=3, late=LinkTimeoutError, lost=LinkLostError
        )

    def send(self, telegram):
        self._check()
        self._link.send(telegram)

    def receive(self, timeout_s):
        self._check()
        reply = self._link.receive(timeout_s)
        self._rig.stall()
        return reply

    def close(self):
        self._link.close()

    def describe(self):
        return self._link.describe()

    def _check(self):
        if self._rig.is_cut():
            raise LinkLostError("cut")


class Rig:
    """A mock brick, the clock it follows, and when its link is down."""

    def __init__(self, world=None, profile="usb", cuts=(), stalls_s=()):
        self.clock = VirtualClock()
        self.host = Host(switch_on(world), self.clock)
        self.profile = profile
        self._cuts = cuts
        self._stalls_s = list(stalls_s)
        self.opened = 0

    def is_cut(self):
        return any(low <= self.clock.now_s() < high for low, high in self._cuts)

    def stall(self):
        """The host stands still between a reply's arrival and its stamp, when it is time for that."""
        if self._stalls_s and self.clock.now_s() >= self._stalls_s[0]:
            self._stalls_s.pop(0)
            self.clock.sleep(0.12)

    def open(self):
        if self.is_cut():
            raise LinkRefusedError("cut", cause=Refusal.UNREACHABLE)
        self.opened += 1
        return Brick(CuttableLink(self), self.clock)


class Outcome(NamedTuple):
    session: Session
    memory: Memory
    rows: list

    def kinds(self):
        return [event.kind for event in self.memory.events]

    def first(self, kind):
        return next((event for event in self.memory.events if event.kind == kind), None)

    def innovations(self, channel):
        return [i for tick in self.memory.ticks for i in tick.innovations if i.channel == channel]


class Rows:
    def __init__(self):
        self.rows = []

    def row(self, values):
        self.rows.append(dict(values))

    def close(self):
        pass


def run(
    rig,
    seconds,
    *,
    ports=("a",),
    program=None,
    sensors=None,
    plant=None,
    candidates=(),
    period_s=0.0,
    **parts,
):
    """Watch a rig for so many virtual seconds."""
    memory, rows = Memory(10**6), Rows()
    twin = BrickTwin(dict.fromkeys(ports, plant or nxt_motor()), TwinOptions(candidates=candidates))
    usual = None if program == "none" else ProgramDriver(program or excitation(ports))
    extra = parts.pop("sinks", [])
    session = Session(
        Parts(
            open_brick=rig.open,
            clock=rig.clock,
            twin=twin,
            sink=Several([memory, *extra]),
            plan=Plan(sensors=sensors or {}, period_s=period_s),
            pace=PACES["bt" if rig.profile == "bluetooth" else "usb"],
            driver=parts.pop("driver", usual),
            recorder=rows,
            **parts,
        )
    )
    session.run(seconds)
    return Outcome(session, memory, rows.rows)


def steady(power, seconds=5.0, mode="drive", ports=("a",)):
    """A program of one command."""
    segment = {"duration_s": seconds, "power_pct": power, "mode": mode}
    runs = [{"name": "steady", "segments": [segment]}]
    return MotorProgram.model_validate({"name": "steady", "ports": ports, "runs": runs, "rest_s": 0.0})


def world_with(tmp_path, **changes):
    """A world file whose motor A has these keys changed or added."""
    from nxt_twin.recording.configs import load_plant_config

    path = tmp_path / "world.yaml"
    battery = changes.pop("battery", None)
    document = {"motors": {"a": {**load_plant_config("nxt_motor"), **changes}}}
    if battery:
        document["battery"] = battery
    path.write_text(yaml.safe_dump(document))
    return path


def mean_square(innovations):
    """The mean of the normalised squares."""
    return float(np.mean([i.normalised_square for i in innovations]))
