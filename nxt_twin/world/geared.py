"""A gear train's inertia on a hub, without the kick that a flywheel on the hub would give to the body.

An NXT motor's rotor turns 48 times as fast as its hub. Nearly all inertia felt at the hub (J) is that of the
small rotor. Its angular momentum is J/48 times the hub's speed, so braking hardly tips the robot. A flywheel
of J on the hub would have all of it, and throws a castor bot over. A bare wheel with a rotor on a gear of 48
is badly conditioned, so the train is lumped anew. A share of J sits on the hub. The rest is a rotor of equal
momentum, which turns the other way at a few times the speed.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from nxt_twin.world.assembly import Gear, Joint, RigidLink, vector

RATIO: Final = -4.0
"""Of the rotor's speed to the hub's. Larger lends less inertia to the body, and is worse conditioned."""
_ON_HUB: Final = 1.0 / (1.0 - RATIO)
"""The share of J on the hub at which hub and rotor have opposite momenta: a = (1 - a) / 4."""
_ROTOR_KG: Final = 1e-3
_ROTOR_ACROSS_KG_M2: Final = 1e-7
_LEAST_LEFT: Final = 0.2


def geared(link: RigidLink, inertia_kg_m2: float) -> tuple[RigidLink, RigidLink, Gear]:
    """A hinged link with its share of a gear train's inertia, the train's rotor, and what holds the two together."""
    if link.joint is None:
        raise ValueError(f"{link.name} hangs on no joint")
    axis = np.abs(link.joint.axis)
    heavier = replace(link, inertia_kg_m2=vector(link.inertia_kg_m2 + _ON_HUB * inertia_kg_m2 * axis))
    spin = (1.0 - _ON_HUB) * inertia_kg_m2 / RATIO**2
    moments = vector(_ROTOR_ACROSS_KG_M2 + (spin - _ROTOR_ACROSS_KG_M2) * axis)
    name = f"{link.name} rotor"
    joint = Joint("hinge", link.joint.at_m, link.joint.axis)
    rotor = RigidLink(name, (), _ROTOR_KG, (0.0, 0.0, 0.0), moments, joint=joint)
    return heavier, rotor, Gear(link.name, name, RATIO)


def relieved(base: RigidLink, axes: list[tuple[Joint, float]]) -> RigidLink:
    """The base without the inertia that its gear trains lend it when it turns with them: each the sum of the two lumps.

    Args:
        base: as its parts make it.
        axes: each train's joint and inertia, kg·m².
    """
    moments = np.array(base.inertia_kg_m2)
    lent = sum(
        (np.abs(joint.axis) * inertia * (_ON_HUB + (1.0 - _ON_HUB) / RATIO**2) for joint, inertia in axes),
        np.zeros(3),
    )
    return replace(base, inertia_kg_m2=vector(np.maximum(moments - lent, _LEAST_LEFT * moments)))
