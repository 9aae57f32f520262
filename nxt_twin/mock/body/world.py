"""A mock brick's surroundings, read from YAML: who it is, its battery, what hangs on its ports."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from random import Random
from typing import Annotated, Any, Literal, final

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, field_validator

from firmware_protocol.limits import BRICK_NAME_SIZE
from nxt_twin.mock.body.battery import (
    DEFAULT_DRAIN_V_PER_C,
    DEFAULT_RESISTANCE_OHM,
    DEFAULT_VOLTAGE_V,
    Battery,
)
from nxt_twin.mock.body.body import Body
from nxt_twin.mock.body.course import Between, TargetCourse, constant
from nxt_twin.mock.body.motors import MotorBank
from nxt_twin.mock.body.sensor import Analog, Sensor, Touch, empty_socket
from nxt_twin.mock.body.ultrasonic import UltrasonicBody
from nxt_twin.mock.errors import WorldError
from nxt_twin.mock.firmware.firmware import DEFAULT_ADDRESS, DEFAULT_NAME, SLEEP_TIMEOUT_MIN, Identity
from nxt_twin.physics.plant import Plant, plant_from_config
from nxt_twin.physics.stepper import Stepper
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.yaml_file import read_model

_DEFAULT_PLANT = "nxt_motor"


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


@final
class CourseModel(_Part):
    """A value over time: points (time s, value), held or joined by lines, once or over and over."""

    points: Annotated[list[tuple[float, float]], Field(min_length=1)]
    between: Between = "step"
    repeat: bool = False

    @field_validator("points")
    @classmethod
    def _in_order(cls, points: list[tuple[float, float]]) -> list[tuple[float, float]]:
        if any(later <= sooner for (sooner, _), (later, _) in pairwise(points)):
            raise ValueError("its times do not increase")
        return points

    def course(self) -> TargetCourse:
        """The course itself."""
        return TargetCourse(self.points, between=self.between, repeat=self.repeat)


def _shape(shown: object) -> str:
    return "course" if isinstance(shown, dict | CourseModel) else "number"


Shown = Annotated[
    Annotated[float, Tag("number")] | Annotated[CourseModel, Tag("course")], Discriminator(_shape)
]
"""A sensor's value: a number, or a course."""


@final
class BatteryModel(_Part):
    """The battery."""

    voltage_v: Annotated[float, Field(ge=0.0, le=12.0)] = DEFAULT_VOLTAGE_V
    internal_resistance_ohm: Annotated[float, Field(ge=0.0)] = DEFAULT_RESISTANCE_OHM
    drain_v_per_c: Annotated[float, Field(ge=0.0)] = DEFAULT_DRAIN_V_PER_C


@final
class TouchModel(_Part):
    """A touch sensor."""

    kind: Literal["touch"]
    pressed: Shown = 0.0


@final
class AnalogModel(_Part):
    """A light, sound or other sensor on the converter; `lit_raw` is for a light sensor with its lamp on."""

    kind: Literal["light", "sound", "analog"]
    raw: Shown = 600.0
    lit_raw: Shown | None = None
    noise_raw: Annotated[float, Field(ge=0.0)] = 0.0


@final
class UltrasonicModel(_Part):
    """An ultrasonic sensor; 255 is no echo."""

    kind: Literal["ultrasonic"]
    distance_cm: Shown = 60.0


@final
class NothingModel(_Part):
    """An empty socket."""

    kind: Literal["none"]


MockSensorModel = Annotated[
    TouchModel | AnalogModel | UltrasonicModel | NothingModel, Field(discriminator="kind")
]


@final
class World(_Part):
    """A brick and what is around it, by default as LEGO ships it with free-running motors.

    `motors` holds a plant for each port: the name of a built-in plant, the path of a plant file, or the
    plant's keys. `robot` and `scene` are read by `nxt_twin.world`, whose sensors stand in for these.
    """

    name: Annotated[str, Field(min_length=1, max_length=BRICK_NAME_SIZE)] = DEFAULT_NAME
    address: Annotated[str, Field(pattern=r"^[0-9A-Fa-f]{2}(:[0-9A-Fa-f]{2}){5}$")] = DEFAULT_ADDRESS.hex(":")
    sleep_timeout_min: Annotated[int, Field(ge=0, le=255)] = SLEEP_TIMEOUT_MIN
    rename_loses_telegrams: bool = False
    battery: BatteryModel = BatteryModel()
    motors: dict[Literal["a", "b", "c"], str | dict[str, Any]] = {}
    sensors: dict[Literal[1, 2, 3, 4], MockSensorModel] = {}
    robot: str | dict[str, Any] | None = None
    scene: dict[str, Any] | None = None

    def identity(self) -> Identity:
        """Who the brick is."""
        address = bytes.fromhex(self.address.replace(":", ""))
        return Identity(self.name, address, self.sleep_timeout_min, self.rename_loses_telegrams)

    def body(self, seed: int = 0, folder: Path | None = None, *, ready: bool = True) -> Body:
        """The brick's body.

        Args:
            seed: of the sensors' noise.
            folder: where paths of plant files start.
            ready: load the compiled plants now, not when a motor first moves.

        Raises:
            PlantError: a motor's plant is none.
        """
        cells = self.battery
        battery = Battery(cells.voltage_v, cells.internal_resistance_ohm, cells.drain_v_per_c)
        plants = [self.plant(port, folder) for port in ("a", "b", "c")]
        random = Random(seed)  # noqa: S311 - noise, not secrets
        sensors = [self._sensor(port, random) for port in (1, 2, 3, 4)]
        return Body(battery, MotorBank(Stepper(plants, ready=ready)), sensors)

    def plant(self, port: Literal["a", "b", "c"], folder: Path | None = None) -> Plant:
        """The plant on a port; `folder` is where paths of plant files start.

        Raises:
            PlantError: it is none.
        """
        given = self.motors.get(port, _DEFAULT_PLANT)
        if isinstance(given, dict):
            return plant_from_config(given, "power_pct")
        is_file = Path(given).suffix in (".yaml", ".yml")
        config = load_plant_config((folder or Path()) / given if is_file else given)
        return plant_from_config(config, "power_pct")

    def _sensor(self, port: Literal[1, 2, 3, 4], random: Random) -> Sensor:
        given = self.sensors.get(port, _DEFAULT_SENSORS[port])
        match given:
            case TouchModel():
                return Touch(_course(given.pressed))
            case AnalogModel():
                lit = None if given.lit_raw is None else _course(given.lit_raw)
                own = Random(random.random())  # noqa: S311
                return Analog(_course(given.raw), lit_raw=lit, noise_raw=given.noise_raw, random=own)
            case UltrasonicModel():
                return UltrasonicBody(_course(given.distance_cm))
            case NothingModel():
                return empty_socket()


_DEFAULT_SENSORS: dict[int, TouchModel | AnalogModel | UltrasonicModel | NothingModel] = {
    1: TouchModel(kind="touch"),
    2: AnalogModel(kind="sound", raw=950.0),
    3: AnalogModel(kind="light", raw=700.0, lit_raw=500.0),
    4: UltrasonicModel(kind="ultrasonic"),
}


def _course(shown: float | CourseModel) -> TargetCourse:
    return shown.course() if isinstance(shown, CourseModel) else constant(shown)


def load_world(path: Path) -> World:
    """Read a world file.

    Raises:
        WorldError: it cannot be read, or holds a key or value that has no meaning.
    """
    return read_model(path, World, WorldError)
