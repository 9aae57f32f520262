"""The true robot: a rigid body on two driven wheels, with an integrator and a slip law of its own."""
