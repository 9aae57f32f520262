"""Start, turn and stop with two motors on B (left) and C (right), so that a diagnosis sees masses and friction.

Powers rise and fall over a fifth of a second, so that no tyre slips. The bridge brakes in its off phase, so that speeds
follow the powers closely. The argument is the seed of powers and directions.
"""

import random
import sys
import time

import nxt.locator
import nxt.motor

PORTS = (nxt.motor.Port.B, nxt.motor.Port.C)
STEPS, STEP_S, ROUNDS = 10, 0.02, 8
REST = (0, 0, 0.4)


def legs(rng):
    """Left power, right power and seconds of each leg: straight, on the spot, an arc to either side, straight back."""
    power, way = rng.randrange(30, 56), rng.choice((-1, 1))
    inner = int(0.5 * power)
    arc = (power, inner) if rng.random() < 0.5 else (inner, power)
    yield from ((power, power, 1.2), REST, (-way * power, way * power, 0.6), REST)
    yield from ((*arc, 1.2), REST, (-power, -power, 0.9), REST)


def put(brick, powers):
    """Drive both motors, unregulated."""
    for port, power in zip(PORTS, powers):
        mode = nxt.motor.Mode.ON | nxt.motor.Mode.BRAKE
        brick.set_output_state(
            port, power, mode, nxt.motor.RegulationMode.IDLE, 0, nxt.motor.RunState.RUNNING, 0
        )


def main():
    rng = random.Random(int(sys.argv[1]) if len(sys.argv) > 1 else 1)  # noqa: S311 - powers, not secrets
    with nxt.locator.find() as brick:
        was = (0, 0)
        for _ in range(ROUNDS):
            for *goal, seconds in legs(rng):
                for step in range(1, STEPS + 1):
                    put(brick, [round(start + (end - start) * step / STEPS) for start, end in zip(was, goal)])
                    time.sleep(STEP_S)
                time.sleep(seconds)
                was = goal


main()
