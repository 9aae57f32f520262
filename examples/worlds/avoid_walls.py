"""Wander for eight seconds without running into anything: ultrasonic on 4, touch on 1; motors on B and C."""

import time

import nxt.locator
import nxt.motor
import nxt.sensor
import nxt.sensor.generic

SECONDS, NEAR_CM, AHEAD, TURN = 8.0, 28, 40, 25


def main():
    with nxt.locator.find() as brick:
        left, right = (brick.get_motor(port) for port in (nxt.motor.Port.B, nxt.motor.Port.C))
        sonar = brick.get_sensor(nxt.sensor.Port.S4, nxt.sensor.generic.Ultrasonic)
        touch = brick.get_sensor(nxt.sensor.Port.S1, nxt.sensor.generic.Touch)

        def go(powers, seconds):
            for motor, power in zip((left, right), powers):
                motor.run(power)
            time.sleep(seconds)

        began = time.time()
        while time.time() - began < SECONDS:
            if touch.is_pressed():
                go((-AHEAD, -AHEAD), 0.8)
                go((TURN, -TURN), 0.6)
            elif sonar.get_distance() < NEAR_CM:
                go((TURN, -TURN), 0.3)
            else:
                go((AHEAD, AHEAD), 0.05)
        for motor in (left, right):
            motor.brake()
        time.sleep(0.3)


main()
