"""Find what a robot's model leaves out: wheels, track, markers, clock and slip, from wheels and an outside pose."""
