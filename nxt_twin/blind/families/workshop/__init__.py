"""A motor as workshops know them: ripple, play that gives, friction that is not quite dry, a tired battery.

Sticking is a dead band of speed (Karnopp); contacts are a spring and a damper (Kelvin and Voigt). Steps of 40
µs are explicit in speed and implicit in current.
"""
