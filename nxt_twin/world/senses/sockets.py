"""The brick's four sockets on a robot: each sensor as the mock takes it, looking at the world."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.random import Generator

from nxt_twin.mock.body.sensor import Analog, Sensor, Touch, empty_socket
from nxt_twin.mock.body.ultrasonic import UltrasonicBody
from nxt_twin.world.blame import blaming
from nxt_twin.world.senses.asked import Asked
from nxt_twin.world.senses.gyro import GyroSense
from nxt_twin.world.senses.held import Held
from nxt_twin.world.senses.light import LightSense
from nxt_twin.world.senses.sound import SoundSense
from nxt_twin.world.senses.surroundings import Surroundings
from nxt_twin.world.senses.touch import TouchSense
from nxt_twin.world.senses.ultrasonic import UltrasonicSense
from nxt_twin.world.sensing import (
    GyroMount,
    LightMount,
    SensorMount,
    SoundMount,
    TouchMount,
    UltrasonicMount,
)

SOCKETS: Final = (1, 2, 3, 4)


def sockets(mounts: dict[int, SensorMount], around: Surroundings, seed: int) -> list[Sensor]:
    """The sensors on ports 1 to 4; nothing is on a port that is not named.

    Raises:
        WorldError: a sensor's configuration is none.
    """
    ultrasonic: list[UltrasonicBody] = []
    streams = np.random.default_rng(seed).spawn(len(SOCKETS))
    found: list[Sensor] = []
    for port, rng in zip(SOCKETS, streams, strict=True):
        with blaming(around.robot_at, "sensors", str(port)):
            mount = mounts.get(port)
            found.append(
                empty_socket() if mount is None else Asked(_socket(mount, port, around, rng, ultrasonic))
            )
    return found


def _socket(
    mount: SensorMount, port: int, around: Surroundings, rng: Generator, ultrasonic: list[UltrasonicBody]
) -> Sensor:
    match mount:
        case UltrasonicMount():
            sense = UltrasonicSense(
                mount, around, rng, lambda: any(o.pinging for o in ultrasonic if o is not own)
            )
            own = UltrasonicBody(sense)
            ultrasonic.append(own)
            return own
        case LightMount():
            unlit, lit = (LightSense(mount, around, rng, lit=lit) for lit in (False, True))
            return Analog(Held(unlit.measure), lit_raw=Held(lit.measure))
        case TouchMount():
            return Touch(Held(TouchSense(mount, port, around, rng).measure))
        case SoundMount():
            return Analog(Held(SoundSense(mount, around, rng).measure))
        case GyroMount():
            return Analog(Held(GyroSense(mount, around, rng).measure))
