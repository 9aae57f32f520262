"""Drive a path with a castor bot: motors on B (left) and C (right), wheels of 56 mm, 103 mm apart.

The path is a YAML file, as `nxt-twin diagnose --experiment-out` writes it: legs of travel_m, turn_deg or rest_s.
"""

import math
import sys
import time
from pathlib import Path

import nxt.locator
import nxt.motor
import yaml

WHEEL_MM, TRACK_MM = 56.0, 103.0
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


def drive(motors, leg):
    """Drive one leg."""
    if "travel_m" in leg:
        ahead = 1000 * leg["travel_m"] / (math.pi * WHEEL_MM) * 360
        turn_by(motors, (ahead, ahead))
    elif "turn_deg" in leg:
        corner = leg["turn_deg"] * TRACK_MM / WHEEL_MM
        turn_by(motors, (-corner, corner))
    else:
        time.sleep(leg["rest_s"])


def main():
    legs = yaml.safe_load(Path(sys.argv[1]).read_text(encoding="utf-8"))["legs"]
    with nxt.locator.find() as brick:
        motors = [brick.get_motor(port) for port in (nxt.motor.Port.B, nxt.motor.Port.C)]
        for leg in legs:
            drive(motors, leg)
        for motor in motors:
            motor.idle()


main()
