"""Drive across a gradient, then back to where it is half as dark as it gets; light sensor on 3, motors on B and C."""

import time

import nxt.locator
import nxt.motor
import nxt.sensor
import nxt.sensor.generic

POWER, SLOW = 35, 12


def main():
    with nxt.locator.find() as brick:
        motors = [brick.get_motor(port) for port in (nxt.motor.Port.B, nxt.motor.Port.C)]
        light = brick.get_sensor(nxt.sensor.Port.S3, nxt.sensor.generic.Light)
        light.set_illuminated(True)
        time.sleep(0.1)

        def go(power):
            for motor in motors:
                motor.run(power)

        brightest = darkest = light.get_lightness()
        go(POWER)
        while light.get_lightness() < darkest + 100:  # beyond its dark end the paper is white again
            brightest, darkest = (
                f(old, light.get_lightness()) for f, old in ((max, brightest), (min, darkest))
            )
            time.sleep(0.02)
        middle = (brightest + darkest) / 2
        go(-SLOW)
        while light.get_lightness() > middle:  # back onto the dark end
            time.sleep(0.02)
        while light.get_lightness() < middle:
            time.sleep(0.02)
        for motor in motors:
            motor.brake()
        time.sleep(0.3)


main()
