"""Lift an arm on motor A to the horizon, 60 degrees from where it rests, hold it for two seconds, and let it down."""

import time

import nxt.locator
import nxt.motor

GOAL_DEG, GAIN, SUM_GAIN, DAMPING = 60, 1.2, 0.04, 0.08


def hold(motor, goal, seconds):
    """Keep the motor at an angle by its count, with a sum that carries the arm's weight."""
    total, last = 0.0, motor.get_tacho().rotation_count
    end = time.time() + seconds
    while time.time() < end:
        count = motor.get_tacho().rotation_count
        error = goal - count
        total = min(max(total + SUM_GAIN * error, -60), 60)
        power = GAIN * error + total - DAMPING * (count - last) / 0.01
        motor.run(round(min(max(power, -70), 70)))
        last = count
        time.sleep(0.01)


def main():
    with nxt.locator.find() as brick:
        motor = brick.get_motor(nxt.motor.Port.A)
        rest = motor.get_tacho().rotation_count
        for tenth in range(1, 11):
            hold(motor, rest + GOAL_DEG * tenth / 10, 0.15)
        hold(motor, rest + GOAL_DEG, 2.0)
        for tenth in range(9, -1, -1):
            hold(motor, rest + GOAL_DEG * tenth / 10, 0.15)
        motor.idle()


main()
