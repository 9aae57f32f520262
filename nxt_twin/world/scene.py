"""A scene as people write it: a floor with what is printed on it, things that stand or lie about, lamps and sounds."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Self, final

from pydantic import Field, model_validator

from nxt_twin.world.assembly import Assembly, Grip, RigidLink, lumped
from nxt_twin.world.parts import Name, Point, PositiveSize, Solid, Written

Shade = Annotated[float, Field(ge=0.0, le=1.0)]
"""The share of light that comes back: 0 is black, 1 is white."""
Spot = tuple[float, float]
Friction = Annotated[float, Field(ge=0.0, le=5.0)]


@final
class Print(Written):
    """Something printed on the floor; give one of the four forms.

    Attributes:
        line_mm: corners of a line, `width_mm` wide.
        disc_mm: its middle, `width_mm` across.
        patch_mm: two opposite corners of a rectangle.
        gradient_mm: two opposite corners of a rectangle, from `shade` at the first x to `to_shade` at the last.
        picture: a PNG file that fills `patch_mm`, grey by its brightness.
    """

    line_mm: Annotated[list[Spot], Field(min_length=2)] | None = None
    disc_mm: Spot | None = None
    patch_mm: tuple[Spot, Spot] | None = None
    gradient_mm: tuple[Spot, Spot] | None = None
    picture: Path | None = None
    width_mm: PositiveSize = 20.0
    shade: Shade = 0.06
    to_shade: Shade = 0.9

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        forms = (self.line_mm, self.disc_mm, self.patch_mm, self.gradient_mm)
        if sum(form is not None for form in forms) != 1:
            raise ValueError("give one of line_mm, disc_mm, patch_mm and gradient_mm")
        if self.picture is not None and self.patch_mm is None:
            raise ValueError("a picture needs the patch_mm that it fills")
        return self


@final
class Floor(Written):
    """The floor, level, its middle at the world's origin.

    Attributes:
        size_mm: of what is printed; beyond it the floor goes on.
        shade: where nothing is printed.
        friction: what the grips of all that stands on it are multiplied by.
        prints: in this order, one over the other.
        grain_mm: how finely the prints are kept.
    """

    size_mm: tuple[PositiveSize, PositiveSize] = (2000.0, 2000.0)
    shade: Shade = 0.85
    friction: Friction = 1.0
    prints: tuple[Print, ...] = ()
    grain_mm: Annotated[float, Field(ge=0.5, le=50.0)] = 2.0


@final
class Carpet(Written):
    """A rectangle of floor with a friction of its own, as high as the rest.

    Attributes:
        patch_mm: two opposite corners.
        friction: as the floor's.
    """

    patch_mm: tuple[Spot, Spot]
    friction: Friction


@final
class Thing(Solid):
    """A thing in the scene; without a mass it stands where it is.

    Attributes:
        mass_g: its mass.
        friction: of its surface.
        rolling_mm: torque against rolling, by its load, as an arm.
        shade: the share of a red lamp's light that comes back from it.
    """

    mass_g: PositiveSize | None = None
    friction: Friction = 0.5
    rolling_mm: Annotated[float, Field(ge=0.0, le=100.0)] = 0.0
    shade: Shade = 0.4

    def assembly(self, name: str) -> Assembly:
        """The thing as one body, its frame in its middle."""
        shape = self.model_copy(update={"at_mm": (0.0, 0.0, 0.0), "turned_deg": (0.0, 0.0, 0.0)}).shape()
        grip = Grip(self.friction, 0.0, 1e-3 * self.rolling_mm)
        link: RigidLink = lumped(name, [(shape, 1e-3 * (self.mass_g or 1.0))], grip)
        return Assembly(name, (link,), fixed=self.mass_g is None)


@final
class Lamp(Written):
    """A lamp that a light sensor without its own sees.

    Attributes:
        at_mm: where it is.
        raw_at_1_m: by how much it lowers a reading that looks straight at it from 1 m.
    """

    at_mm: Point
    raw_at_1_m: Annotated[float, Field(ge=0.0, le=1023.0)] = 150.0


@final
class Sound(Written):
    """A sound source.

    Attributes:
        at_mm: where it is.
        db_at_1_m: sound pressure level at 1 m, dB.
        hz: its tone.
        during_s: from when to when it sounds; None is always.
    """

    at_mm: Point
    db_at_1_m: Annotated[float, Field(ge=0.0, le=140.0)] = 70.0
    hz: PositiveSize = 1000.0
    during_s: tuple[float, float] | None = None


@final
class Room(Written):
    """The room.

    Attributes:
        light_raw: by how much its light lowers every light sensor's reading.
        mains_raw, mains_hz: amplitude and frequency of its flicker.
        noise_db: the level where nothing sounds.
        air_c: temperature of the air.
    """

    light_raw: Annotated[float, Field(ge=-1023.0, le=1023.0)] = 0.0
    mains_raw: Annotated[float, Field(ge=0.0, le=500.0)] = 0.0
    mains_hz: PositiveSize = 100.0
    noise_db: Annotated[float, Field(ge=0.0, le=140.0)] = 35.0
    air_c: Annotated[float, Field(ge=-40.0, le=80.0)] = 20.0


@final
class StartPose(Written):
    """Where the robot's frame is at first.

    Attributes:
        at_mm: x and y; or x, y and height.
        heading_deg: counter-clockwise from x.
        pitch_deg: forward from upright, about the frame's y axis.
    """

    at_mm: Annotated[tuple[float, ...], Field(min_length=2, max_length=3)] = (0.0, 0.0)
    heading_deg: float = 0.0
    pitch_deg: float = 0.0


@final
class Scene(Written):
    """The surroundings of a robot.

    Attributes:
        floor, carpets, things, lamps, sounds, room: see there.
        slope_deg: how steep the floor is; it rises towards `uphill_deg`, counter-clockwise from x.
        start: where the robot begins.
    """

    floor: Floor = Floor()
    carpets: tuple[Carpet, ...] = ()
    things: dict[Name, Thing] = Field(default_factory=dict)
    lamps: tuple[Lamp, ...] = ()
    sounds: tuple[Sound, ...] = ()
    room: Room = Room()
    slope_deg: Annotated[float, Field(ge=0.0, le=45.0)] = 0.0
    uphill_deg: float = 0.0
    start: StartPose = StartPose()
