"""Drive a square of 25 cm with a castor bot: motors on B (left) and C (right), wheels of 56 mm, 103 mm apart."""

import math
import time

import nxt.locator
import nxt.motor

WHEEL_MM, TRACK_MM, SIDE_MM = 56.0, 103.0, 250.0
GAIN_PER_DEG, RAMP, SLOWEST, QUICKEST, NEAR_DEG = 0.2, 1, 2, 50, 2


def turn_by(motors, degrees):
    """Turn each motor by its number of degrees: quicker at first, slower towards the end, so that no tyre slips."""
    goals = {motor: motor.get_tacho().rotation_count + by for motor, by in zip(motors, degrees)}
    top = 0
    while goals:
        top = min(top + RAMP, QUICKEST)
        for motor, goal in list(goals.items()):
            left = goal - motor.get_tacho().rotation_count
            if abs(left) <= NEAR_DEG:
                motor.brake()
                del goals[motor]
            else:
                power = min(max(abs(left) * GAIN_PER_DEG, SLOWEST), top)
                motor.run(round(math.copysign(power, left)))
        time.sleep(0.01)
    time.sleep(0.2)


def main():
    with nxt.locator.find() as brick:
        motors = [brick.get_motor(port) for port in (nxt.motor.Port.B, nxt.motor.Port.C)]
        ahead = SIDE_MM / (math.pi * WHEEL_MM) * 360
        corner = 90 * TRACK_MM / WHEEL_MM
        for _ in range(4):
            turn_by(motors, (ahead, ahead))
            turn_by(motors, (-corner, corner))
        for motor in motors:
            motor.idle()


main()
