"""The motor in which nothing is concealed, as every family takes it."""

from nxt_twin.blind.families.numbers import Numbers

PLAIN = Numbers(
    resistance_ohm=7.6,
    inductance_h=4.88e-3,
    torque_constant_nm_per_a=0.49,
    viscous_friction_nm_s_per_rad=1.9e-3,
    inertia_kg_m2=1.2e-3,
    supply_v=8.0,
    coulomb_forward_nm=8.5e-3,
    coulomb_reverse_nm=8.5e-3,
)
