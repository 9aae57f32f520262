"""Follow the right edge of a black line with one light sensor on port 3; motors on B (left) and C (right)."""

import time

import nxt.locator
import nxt.motor
import nxt.sensor
import nxt.sensor.generic

SECONDS, SPEED, GAIN, TURN_MOST = 10.0, 30, 0.18, 40


def main():
    with nxt.locator.find() as brick:
        left, right = (brick.get_motor(port) for port in (nxt.motor.Port.B, nxt.motor.Port.C))
        light = brick.get_sensor(nxt.sensor.Port.S3, nxt.sensor.generic.Light)
        light.set_illuminated(True)
        time.sleep(0.1)
        white = light.get_lightness()
        goal = white - 200  # about halfway down to black
        began = time.time()
        while time.time() - began < SECONDS:
            error = light.get_lightness() - goal
            turn = min(max(GAIN * error, -TURN_MOST), TURN_MOST)
            left.run(round(SPEED - turn))
            right.run(round(SPEED + turn))
            time.sleep(0.01)
        for motor in (left, right):
            motor.idle()


main()
