"""Readings of the brick's sensors in the world around a robot, by the models of `nxt_twin.sensors`."""
