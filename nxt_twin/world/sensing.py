"""Sensors as people mount them on a robot: where they sit, where they look, and which model they follow."""

from __future__ import annotations

from typing import Annotated, Literal, final

from pydantic import Field

from nxt_twin.world.assembly import Grip, Joint, RigidLink, Shape, Vector, lumped, rotation, vector
from nxt_twin.world.parts import Point, PositiveSize, Written, metres, painted, radians


class Mounted(Written):
    """A sensor's place on the robot.

    Attributes:
        at_mm: its face.
        facing_deg: pitch (down is positive) and yaw (left is positive) of where it looks from straight ahead.
    """

    at_mm: Point
    facing_deg: tuple[float, float] = (0.0, 0.0)

    @property
    def turned_rad(self) -> Vector:
        """Its turn on the robot."""
        pitch, yaw = self.facing_deg
        return radians((0.0, pitch, yaw))

    @property
    def looking(self) -> Vector:
        """The unit vector of where it looks, in the robot's frame."""
        return vector(rotation(self.turned_rad)[:, 0])


@final
class UltrasonicMount(Mounted):
    """An ultrasonic sensor; `model` is a sensor's configuration, by name or file."""

    kind: Literal["ultrasonic"]
    model: str = "nxt_ultrasonic"


@final
class LightMount(Mounted):
    """A light sensor that looks at the floor or at what is before it.

    Attributes:
        model, unlit_model: its configuration with the lamp on and off.
        spot_mm: diameter of what it sees at `best_mm`.
        best_mm: the distance for which the model's numbers hold.
        fade_mm: the distance beyond it over which the lamp's light halves.
    """

    kind: Literal["light"]
    model: str = "nxt_light_reflected"
    unlit_model: str = "nxt_light_ambient"
    spot_mm: PositiveSize = 12.0
    best_mm: PositiveSize = 10.0
    fade_mm: PositiveSize = 15.0


@final
class TouchMount(Mounted):
    """A touch sensor: a bumper on its plunger, which slides back against a spring.

    Attributes:
        bumper_mm: depth, width and height of what is pushed.
        model: its configuration.
        travel_mm: how far it goes in.
        preload_g: force at which it begins to move; the spring then grows so that the model's travel takes its force.
    """

    kind: Literal["touch"]
    model: str = "nxt_touch"
    bumper_mm: tuple[PositiveSize, PositiveSize, PositiveSize] = (6.0, 60.0, 16.0)
    travel_mm: PositiveSize = 3.5
    preload_g: Annotated[float, Field(ge=0.0, le=1000.0)] = 10.0
    mass_g: PositiveSize = 5.0

    def plunger(self, name: str) -> RigidLink:
        """The bumper as a link that slides along where the sensor looks; at rest it is all the way out."""
        size = metres(self.bumper_mm)
        shape = Shape("box", size, (0.5 * size[0], 0.0, 0.0), (0.0, 0.0, 0.0), painted("orange"))
        joint = Joint("slide", metres(self.at_mm), self.looking, (-1e-3 * self.travel_mm, 0.0))
        return lumped(name, [(shape, 1e-3 * self.mass_g)], Grip(0.3), joint)


@final
class SoundMount(Mounted):
    """A sound sensor."""

    kind: Literal["sound"]
    model: str = "nxt_sound_db"


@final
class GyroMount(Mounted):
    """A rate gyro on an analog port (HiTechnic's NGY1044: one raw step a degree per second).

    Attributes:
        axis: about which it measures, in the robot's frame.
        rest_raw: the reading at rest.
        raw_per_deg_s: its gain.
        noise_raw: standard deviation of a reading.
    """

    kind: Literal["gyro"]
    axis: Literal["x", "y", "z", "-x", "-y", "-z"] = "y"
    rest_raw: float = 600.0
    raw_per_deg_s: float = 1.0
    noise_raw: Annotated[float, Field(ge=0.0, le=100.0)] = 0.5


SensorMount = Annotated[
    UltrasonicMount | LightMount | TouchMount | SoundMount | GyroMount, Field(discriminator="kind")
]
