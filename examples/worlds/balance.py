"""Balance on two wheels for thirty seconds, or as many as are given: motors on B and C, HiTechnic's gyro on port 1.

The gains are those of a linear-quadratic regulator for the NXTway-GS with a period of 20 ms and one period's delay.
"""

import math
import sys
import time

import nxt.locator
import nxt.motor
import nxt.sensor
import nxt.sensor.hitechnic

PERIOD_S = 0.02
GAINS = (-8.07, -570.0, -18.0, -54.4, 0.406)  # wheel, pitch, their rates, the last power


def main(seconds):
    with nxt.locator.find() as brick:
        ports = (nxt.motor.Port.B, nxt.motor.Port.C)
        gyro = brick.get_sensor(nxt.sensor.Port.S1, nxt.sensor.hitechnic.Gyro)
        gyro.set_zero(sum(gyro.get_rotation_speed() for _ in range(20)) / 20)  # hold it upright meanwhile

        def drive(power):
            for port in ports:
                brick.set_output_state(
                    port, power, nxt.motor.Mode.ON | nxt.motor.Mode.BRAKE, nxt.motor.RegulationMode.IDLE, 0,
                    nxt.motor.RunState.RUNNING, 0,
                )  # fmt: skip

        pitch, power, hub = 0.0, 0.0, 0.0
        last_hub, last = 0.0, time.time()
        end = last + seconds
        while time.time() < end:
            rate = math.radians(gyro.get_rotation_speed())
            counts = [brick.get_output_state(port)[-1] for port in ports]
            now = time.time()
            pitch += rate * (now - last)
            hub = math.radians(sum(counts) / 2)
            hub_rate, last_hub = (hub - last_hub) / max(now - last, 1e-3), hub
            last = now
            wheel, wheel_rate = hub + pitch, hub_rate + rate
            power = -sum(gain * state for gain, state in zip(GAINS, (wheel, pitch, wheel_rate, rate, power)))
            power = min(max(power, -100), 100)
            drive(round(power))
            time.sleep(max(0.0, now + PERIOD_S - time.time() - 0.004))
        drive(0)


main(float(sys.argv[1]) if len(sys.argv) > 1 else 30.0)
