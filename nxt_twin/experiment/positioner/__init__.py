"""What moves the target or the sensor: a hand, a rail driven by an NXT motor, an industrial robot."""
