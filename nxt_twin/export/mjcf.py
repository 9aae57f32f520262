"""A motor as MuJoCo's joint and actuator; the control is the voltage at the winding."""

from __future__ import annotations

from typing import Final

from nxt_twin.export.axis import Axis, written

STEP_S: Final = 5e-4
_HUB_SHARE: Final = 1e-3
"""Of the inertia that the hub's body has, as MuJoCo wants bodies to have some; the rest is the joint's armature."""


def mjcf(axis: Axis, told: tuple[str, ...]) -> str:
    """A hub that turns about z: torque K(U - Ke·speed)/R, viscous and dry friction."""
    comments = "\n".join(f"<!-- {line} -->" for line in told)
    gain = axis.torque_constant_nm_per_a / axis.resistance_ohm
    hub = axis.inertia_kg_m2 * _HUB_SHARE
    moment, supply = written(hub), written(axis.supply_v)
    return f"""{comments}
<mujoco model="{axis.name}">
  <compiler angle="radian"/>
  <option timestep="{STEP_S}" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody>
    <body name="{axis.name}_hub">
      <joint name="{axis.name}" type="hinge" axis="0 0 1" armature="{written(axis.inertia_kg_m2 - hub)}"
             damping="{written(axis.viscous_friction_nm_s_per_rad)}"
             frictionloss="{written(axis.coulomb_friction_nm)}" solreffriction="0.001 1"/>
      <inertial pos="0 0 0" mass="0.05" diaginertia="{moment} {moment} {moment}"/>
    </body>
  </worldbody>
  <actuator>
    <general name="{axis.name}_volts" joint="{axis.name}" ctrllimited="true" ctrlrange="-{supply} {supply}"
             gaintype="fixed" gainprm="{written(gain)}"
             biastype="affine" biasprm="0 0 {written(-gain * axis.back_emf_v_s_per_rad)}"/>
  </actuator>
</mujoco>
"""
