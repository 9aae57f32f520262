"""A motor whose dry friction is two sets of bristles (LuGre), integrated by SciPy's Radau method.

Stiff and smooth where other families switch; a stop is an event that turns the speed round.
"""
