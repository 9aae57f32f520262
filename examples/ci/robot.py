"""A robot's program, written for a brick: drive until the bumper is pressed or a wall is near."""

from __future__ import annotations

import time

import nxt.locator
import nxt.motor
import nxt.sensor
import nxt.sensor.generic


def drive_until_stopped(brick, *, nearest_cm: float = 20.0, timeout_s: float = 5.0) -> str:
    """Drive port A; says what stopped it: bumper, wall or timeout."""
    bumper = brick.get_sensor(nxt.sensor.Port.S1, nxt.sensor.generic.Touch)
    eyes = brick.get_sensor(nxt.sensor.Port.S4, nxt.sensor.generic.Ultrasonic)
    motor = brick.get_motor(nxt.motor.Port.A)
    end_s = time.monotonic() + timeout_s
    motor.run(60)
    try:
        while time.monotonic() < end_s:
            if bumper.is_pressed():
                return "bumper"
            if eyes.get_distance() <= nearest_cm:
                return "wall"
        return "timeout"
    finally:
        motor.idle()


if __name__ == "__main__":
    with nxt.locator.find() as found:
        print(drive_until_stopped(found))
