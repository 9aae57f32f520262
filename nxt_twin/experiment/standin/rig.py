"""A rig round a mock brick: where things stand, what moves them there, and what its sensors make of it.

The sensors here are mechanisms: an echo that is too weak, a button with a snap, a diode. They share no
code with `nxt_twin.sensors`, which fits their recordings.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from random import Random
from typing import Final, final

from nxt_twin.experiment.positioner.positioner import Limits, OneAxis, PositionerAxis, within
from nxt_twin.mock.body.body import Body
from nxt_twin.mock.body.course import constant
from nxt_twin.mock.body.sensor import Analog, Touch
from nxt_twin.mock.body.ultrasonic import UltrasonicBody

_NO_ECHO: Final = 255.0
_REDRAWS: Final = 1000


@final
class Rig:
    """The true values round the brick; each is set, or follows something."""

    def __init__(self) -> None:
        self._values: dict[PositionerAxis, Callable[[], float]] = {}

    def set(self, axis: PositionerAxis, value: float) -> None:
        """Put it there."""
        self._values[axis] = lambda: value

    def follow(self, axis: PositionerAxis, source: Callable[[], float]) -> None:
        """Let it go with something, such as a carriage on a rail."""
        self._values[axis] = source

    def value(self, axis: PositionerAxis) -> float:
        """Where it is; 0 if it was never put anywhere."""
        source = self._values.get(axis)
        return 0.0 if source is None else source()


@final
class RigMover(OneAxis):
    """A positioner that sets a rig at once and exactly.

    Args:
        rig: what it moves.
        axis: which of its axes.
        limits: where it may go.
    """

    def __init__(self, rig: Rig, axis: PositionerAxis, limits: Limits | None = None) -> None:
        super().__init__(axis, limits)
        self._rig = rig

    def move_to(self, value: float) -> float:
        """Set it."""
        self._rig.set(self._axis, within(self._limits, self._axis, value))
        return value


@final
class Carriage:
    """A carriage on a rail that a mock's motor drives, with play between them.

    Args:
        body: the mock's body.
        port: the motor's port, 0 to 2.
        mm_per_deg: of the hub.
        play_deg: play in the gears.
        start_mm: where it stands at first.
    """

    def __init__(
        self, body: Body, port: int, mm_per_deg: float, play_deg: float = 0.0, start_mm: float = 0.0
    ) -> None:
        self._body = body
        self._port = port
        self._mm_per_deg = mm_per_deg
        self._play_deg = play_deg
        self._start_mm = start_mm
        self._carried_deg = 0.0
        body.followers.append(self._follow)

    def place_mm(self) -> float:
        """Where it is now."""
        return self._start_mm + self._carried_deg * self._mm_per_deg

    def _follow(self) -> None:
        """It is pushed along at either end of the play; at first it was last moved forward."""
        hub_deg = math.degrees(self._body.motors.angles_rad()[self._port])
        self._carried_deg = min(max(self._carried_deg, hub_deg), hub_deg + self._play_deg)


@final
@dataclass(frozen=True)
class Echo:
    """How an ultrasonic sensor hears its target; lengths in mm, angles in deg.

    Attributes:
        stretch: of the measured distance over the true one.
        shift: added to it.
        jitter: standard deviation at distance 0.
        jitter_per_mm: by how much that grows with distance.
        deaf_below: nothing is heard of nearer targets.
        early_below: below this, `early_share` of the echoes are taken `early_shift` wrong.
        early_shift, early_share: see there.
        beam: corners (distance, angle) of the line at which the echo's strength is just enough; empty: any angle.
        wobble: standard deviation of the angle at which it is, from ping to ping.
    """

    stretch: float = 1.0055
    shift: float = 0.013
    jitter: float = 2.0
    jitter_per_mm: float = 0.004
    deaf_below: float = 40.0
    early_below: float = 250.0
    early_shift: float = 20.0
    early_share: float = 0.8
    beam: tuple[tuple[float, float], ...] = ((0.0, 30.0), (438.0, 55.0), (1538.0, 15.0))
    wobble: float = 2.0

    def hear(self, distance: float, angle: float, random: Random) -> float:
        """A measured distance in cm, before the sensor rounds it; 255 without an echo."""
        if distance < self.deaf_below:
            return _NO_ECHO
        if self.beam and abs(angle) > self._edge(distance) + random.gauss(0.0, self.wobble):
            return _NO_ECHO
        measured = self.stretch * distance + self.shift
        if distance < self.early_below and random.random() < self.early_share:
            measured += self.early_shift
        measured += random.gauss(0.0, 1.0) * (self.jitter + self.jitter_per_mm * distance)
        return min(measured / 10.0, _NO_ECHO - 1.0)

    def _edge(self, distance: float) -> float:
        for (d0, a0), (d1, a1) in zip(self.beam, self.beam[1:], strict=False):
            if distance <= d1:
                return a0 + (a1 - a0) * (distance - d0) / (d1 - d0)
        return self.beam[-1][1]


@final
@dataclass(frozen=True)
class Diode:
    """How a light sensor sees a printed gradient, in raw readings.

    Attributes:
        per_mm: slope along the gradient.
        dark: the reading at its beginning without any room light.
        room: what the room's light adds now.
        grain: standard deviation of the reading.
        mains_raw, mains_hz: a flicker of the room's light; 0 is none.
    """

    per_mm: float = -1.1
    dark: float = 620.0
    room: float = 0.0
    grain: float = 2.0
    mains_raw: float = 0.0
    mains_hz: float = 100.0

    def see(self, position: float, time_s: float, random: Random) -> float:
        """One reading, before it is rounded."""
        mains = self.mains_raw * math.cos(2.0 * math.pi * self.mains_hz * time_s)
        return self.dark + self.room + self.per_mm * position + mains + random.gauss(0.0, self.grain)


@final
@dataclass
class Button:
    """A button that snaps at one force (or travel) and back at a smaller one, a little different each time.

    Attributes:
        press, release: where it snaps, in the axis' unit.
        scatter: standard deviation of both from stroke to stroke.
        random: draws them.
    """

    press: float
    release: float
    scatter: float
    random: Random
    _down: bool = False
    _next: float = field(default=math.nan)

    def feel(self, push: float) -> bool:
        """Whether it is down under this push."""
        if math.isnan(self._next):
            self._next = self.random.gauss(self.press, self.scatter)
        if self._down and push <= self._next:
            self._down, self._next = False, self._beyond(push, self.press, above=True)
        elif not self._down and push >= self._next:
            self._down, self._next = True, self._beyond(push, self.release, above=False)
        return self._down

    def _beyond(self, push: float, middle: float, *, above: bool) -> float:
        """Where it snaps next, which is not here: it would snap back at once."""
        for _ in range(_REDRAWS):
            drawn = self.random.gauss(middle, self.scatter)
            if drawn > push if above else drawn < push:
                return drawn
        return math.nextafter(push, math.inf if above else -math.inf)


@final
@dataclass(frozen=True)
class _Shown:
    read: Callable[[float], float]

    def at(self, time_s: float) -> float:
        return self.read(time_s)


def place_ultrasonic(body: Body, slot: int, rig: Rig, echo: Echo, random: Random) -> None:
    """Put the sensor on port `slot` (0 to 3) in front of the rig's target."""
    body.sensors[slot] = UltrasonicBody(
        _Shown(lambda _: echo.hear(rig.value("distance_mm"), rig.value("angle_deg"), random))
    )


def place_light(body: Body, slot: int, rig: Rig, diode: Callable[[], Diode], random: Random) -> None:
    """Put a light sensor on port `slot` over the rig's gradient; `diode` is asked at every reading."""
    body.sensors[slot] = Analog(_Shown(lambda t: diode().see(rig.value("position_mm"), t, random)))


def place_button(body: Body, slot: int, rig: Rig, axis: PositionerAxis, button: Button) -> None:
    """Put a touch sensor on port `slot` under the rig's force or travel."""
    body.sensors[slot] = Touch(_Shown(lambda _: float(button.feel(rig.value(axis)))))


@final
@dataclass(frozen=True)
class Transducers:
    """Two ultrasonic sensors that see one wall, and a strip that is slid over the first one's face; mm.

    Attributes:
        receiver, emitter: places of the two openings' middles along the face.
        radius: of each opening.
        strip: width of the strip.
        enough: share of an opening that has to be free.
        chance: probability of an echo where nothing is covered.
    """

    receiver: float = -16.0
    emitter: float = 16.0
    radius: float = 8.0
    strip: float = 20.0
    enough: float = 0.35
    chance: float = 0.97

    def hear(self, place: float, *, together: bool, distance: float, random: Random) -> float:
        """The first sensor's reading, cm, with the strip at `place`, with or without the other sensor's pings."""
        listens = self._free(self.receiver, place) >= self.enough
        speaks = together or self._free(self.emitter, place) >= self.enough
        heard = listens and speaks and random.random() < self.chance
        return distance / 10.0 if heard else _NO_ECHO

    def _free(self, middle: float, place: float) -> float:
        """The share of a round opening that a strip leaves free."""
        return (
            1.0
            - _left_of(place + 0.5 * self.strip - middle, self.radius)
            + _left_of(place - 0.5 * self.strip - middle, self.radius)
        )


def _left_of(cut: float, radius: float) -> float:
    """The share of a disc on the left of a straight cut."""
    u = min(max(cut / radius, -1.0), 1.0)
    return 0.5 + (u * math.sqrt(1.0 - u * u) + math.asin(u)) / math.pi


def place_transducers(
    body: Body, slots: tuple[int, int], rig: Rig, pair: Transducers, random: Random, wall_mm: float = 500.0
) -> None:
    """Put two sensors before a wall, the first one under test with the rig's strip over its face.

    Args:
        body: the mock's body.
        slots: ports of the one under test and of the other, 0 to 3.
        rig: has the strip's place.
        pair: where the openings are.
        random: chance of the echoes.
        wall_mm: distance of the wall.
    """
    other = UltrasonicBody(constant(wall_mm / 10.0))

    def read(_: float) -> float:
        return pair.hear(rig.value("position_mm"), together=other.pinging, distance=wall_mm, random=random)

    body.sensors[slots[0]] = UltrasonicBody(_Shown(read))
    body.sensors[slots[1]] = other
