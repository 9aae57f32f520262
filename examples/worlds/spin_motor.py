"""Let the motor on A turn at half power for two seconds."""

import time

import nxt.locator
import nxt.motor

with nxt.locator.find() as brick:
    motor = brick.get_motor(nxt.motor.Port.A)
    motor.run(50)
    time.sleep(2)
    motor.run(50)
