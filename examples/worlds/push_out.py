"""Push the other robot out of the ring.

Turn until the ultrasonic sensor on 4 sees it, on until it is out of sight, and back by half of that. Push until the
light sensor on 3 sees the ring's white edge, and back off. Motors on B (left) and C (right).
"""

import time

import nxt.locator
import nxt.motor
import nxt.sensor
import nxt.sensor.generic

SEEN_CM, TURN, PUSH, EDGE = 60, 10, 70, 120


def main():
    with nxt.locator.find() as brick:
        left, right = (brick.get_motor(port) for port in (nxt.motor.Port.B, nxt.motor.Port.C))
        sonar = brick.get_sensor(nxt.sensor.Port.S4, nxt.sensor.generic.Ultrasonic)
        light = brick.get_sensor(nxt.sensor.Port.S3, nxt.sensor.generic.Light)
        light.set_illuminated(True)
        time.sleep(0.1)
        black = light.get_lightness()

        def go(left_power, right_power, seconds=0.02):
            left.run(left_power)
            right.run(right_power)
            time.sleep(seconds)

        def turn_until(seen):
            while (sonar.get_distance() <= SEEN_CM) != seen:
                go(TURN, -TURN)
            return left.get_tacho().rotation_count

        middle = (turn_until(seen=True) + turn_until(seen=False)) / 2
        while left.get_tacho().rotation_count > middle:
            go(-TURN, TURN, 0.01)
        while light.get_lightness() < black + EDGE:
            go(PUSH, PUSH, 0.01)
        go(-40, -40, 0.6)
        for motor in (left, right):
            motor.brake()
        time.sleep(0.3)


main()
