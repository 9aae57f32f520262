"""A motor's hub as a URDF joint."""

from __future__ import annotations

from nxt_twin.export.axis import Axis, written


def urdf(axis: Axis, told: tuple[str, ...]) -> str:
    """A base and a hub that turns about z, with friction, damping, and the motor's limits."""
    inertia = written(axis.inertia_kg_m2)
    comments = "\n".join(f"<!-- {line} -->" for line in told)
    return f"""<?xml version="1.0"?>
{comments}
<robot name="{axis.name}">
  <link name="{axis.name}_base"/>
  <link name="{axis.name}_hub">
    <inertial>
      <mass value="0.05"/>
      <inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/>
    </inertial>
  </link>
  <joint name="{axis.name}" type="continuous">
    <parent link="{axis.name}_base"/>
    <child link="{axis.name}_hub"/>
    <axis xyz="0 0 1"/>
    <dynamics damping="{written(axis.viscous_friction_nm_s_per_rad)}" friction="{written(axis.coulomb_friction_nm)}"/>
    <limit effort="{written(axis.stall_torque_nm)}" velocity="{written(axis.free_speed_rad_per_s)}"/>
  </joint>
</robot>
"""
