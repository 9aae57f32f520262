"""Sort six balls: a cradle on motor A tips red ones to the left and blue ones to the right; light sensor on 3."""

import math
import time

import nxt.locator
import nxt.motor
import nxt.sensor
import nxt.sensor.generic

BALLS, TIP_DEG, GAIN, MOST, SEEN, RED = 6, 65, 0.8, 40, 40, 200


def turn_to(motor, goal, seconds):
    """Turn the cradle to an angle and hold it there."""
    end = time.time() + seconds
    while time.time() < end:
        error = goal - motor.get_tacho().rotation_count
        power = min(2 + GAIN * abs(error), MOST)
        motor.run(round(math.copysign(power, error)) if abs(error) > 1 else 0)
        time.sleep(0.01)
    motor.brake()


def main():
    with nxt.locator.find() as brick:
        motor = brick.get_motor(nxt.motor.Port.A)
        light = brick.get_sensor(nxt.sensor.Port.S3, nxt.sensor.generic.Light)
        light.set_illuminated(True)
        motor.brake()
        time.sleep(0.05)
        empty = light.get_lightness()
        for _ in range(BALLS):
            while light.get_lightness() < empty + SEEN:
                time.sleep(0.02)
            time.sleep(0.3)
            is_red = light.get_lightness() > empty + RED
            turn_to(motor, TIP_DEG if is_red else -TIP_DEG, 0.6)
            turn_to(motor, 0, 0.9)
        motor.idle()


main()
