"""What a robot's model leaves out: wheels, track, markers, clock and slip, told from wheels and outside pose."""
