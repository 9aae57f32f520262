"""The source paper, recomputed: what it prints beside what its own data and equations give.

Gonçalves, Lima, Malheiros, Costa: "Sensor and actuator stochastic modeling of the Lego Mindstorms NXT educational kit".
"""
