"""A motor as workshops know them: ripple, play that gives, friction that is not quite dry, a tired battery.

Sticking by a dead band of speed (Karnopp), contacts of spring and damper (Kelvin and Voigt), steps of 40 µs that are
explicit in speed and implicit in current.
"""
