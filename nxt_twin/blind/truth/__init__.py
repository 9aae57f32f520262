"""A simulator of an NXT motor that shares nothing with the models that are fitted to it.

Explicit Runge-Kutta steps of at most 25 µs, elastic bristles for dry friction, contact by penalty.
"""
