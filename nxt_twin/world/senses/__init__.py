"""What the brick's sensors make of the world around a robot, by the models of `nxt_twin.sensors`."""
