"""Drive on until the ultrasonic sensor on port 4 sees something nearer than 25 cm, then stop; motors on B and C."""

import time

import nxt.locator
import nxt.motor
import nxt.sensor
import nxt.sensor.generic

NEAR_CM, POWER = 25, 40


def main():
    with nxt.locator.find() as brick:
        motors = [brick.get_motor(port) for port in (nxt.motor.Port.B, nxt.motor.Port.C)]
        sonar = brick.get_sensor(nxt.sensor.Port.S4, nxt.sensor.generic.Ultrasonic)
        while sonar.get_distance() > NEAR_CM:
            for motor in motors:
                motor.run(POWER)
            time.sleep(0.02)
        for motor in motors:
            motor.brake()
        time.sleep(0.5)


main()
