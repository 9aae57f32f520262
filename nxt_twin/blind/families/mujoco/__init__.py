"""Motors in MuJoCo: its integrator and solver, friction loss, limits, tendons, bodies that hang and collide.

The winding, the bridge and the battery are this family's own.
"""
