"""Drive a square of 40 cm with a castor bot: motors on B (left) and C (right), wheels of 56 mm, 103 mm apart."""

import math
import time

import nxt.locator
import nxt.motor

WHEEL_MM, TRACK_MM, SIDE_MM = 56.0, 103.0, 400.0
GAIN_PER_DEG, RAMP, SLOWEST, QUICKEST = 0.3, 1, 5, 50


def turn_by(motors, degrees):
    """Turn each motor by so many degrees: quicker at first, slower towards the end, so that no tyre slips."""
    goals = [motor.get_tacho().rotation_count + by for motor, by in zip(motors, degrees)]
    settled, top = 0, 0
    while settled < 10:
        left = [goal - motor.get_tacho().rotation_count for motor, goal in zip(motors, goals)]
        settled = settled + 1 if all(abs(by) <= 1 for by in left) else 0
        top = min(top + RAMP, QUICKEST)
        for motor, by in zip(motors, left):
            power = min(max(abs(by) * GAIN_PER_DEG, SLOWEST), top)
            motor.run(round(math.copysign(power, by)) if abs(by) > 1 else 0)
        time.sleep(0.01)
    for motor in motors:
        motor.brake()


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
