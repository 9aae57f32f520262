"""The motor's bodies as an MJCF model."""

from __future__ import annotations

import math
from typing import Final

from nxt_twin.blind.families.numbers import NEVER_S, Numbers

GRAVITY_M_PER_S2: Final = 9.81
ARM_M: Final = 0.03
BRISTLE_SHARE: Final = 0.02
LONGEST_STEP_S: Final = 3e-4
SWINGING_MASS, SLACK_ROPE, SPRUNG_BUMP, ROLLING_BALLAST = 1, 2, 3, 4


def hangs(motor: Numbers) -> bool:
    """Whether an arm with a payload is on the hub: both its weight and its inertia."""
    return motor.gravity_torque_nm > 0.0 and motor.added_inertia_kg_m2 > 0.0


def motor_mjcf(motor: Numbers) -> str:
    """The model as XML: a hub on a hinge, and what is on it; the axis is level, gravity along -y."""
    return f"""<mujoco model="motor">
  <option timestep="{LONGEST_STEP_S}" gravity="0 {-GRAVITY_M_PER_S2} 0" integrator="implicitfast" iterations="30"/>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>
    <body name="hub">
      {_hub_joint(motor)}
      <inertial pos="0 0 0" mass="0.05" diaginertia="{_thrice(_own_inertia(motor))}"/>
      {_on_hub(motor)}
    </body>
    {_beside(motor)}
  </worldbody>
  {_tendons(motor)}
</mujoco>"""


def _own_inertia(motor: Numbers) -> float:
    """The hub's inertia without the arm that a plain weight hangs on: together they are the motor's."""
    if motor.gravity_torque_nm > 0.0 and not hangs(motor):
        return motor.inertia_kg_m2 - motor.gravity_torque_nm / GRAVITY_M_PER_S2 * ARM_M
    return motor.inertia_kg_m2


def _hub_joint(motor: Numbers) -> str:
    limits = ""
    if motor.stop_side != 0.0:
        low, high = (-1e3, motor.stop_rad) if motor.stop_side > 0.0 else (motor.stop_rad, 1e3)
        limits = f'limited="true" range="{math.degrees(low)} {math.degrees(high)}" solreflimit="0.006 0.6"'
    borne = motor.share * motor.coulomb_nm if motor.load_inertia_kg_m2 > 0.0 else 0.0  # by the load's joint
    dry = 0.0 if motor.presliding_rad > 0.0 else motor.coulomb_nm - borne
    spring = f'stiffness="{motor.spring_nm_per_rad}" springref="{math.degrees(motor.spring_rest_rad)}"'
    return (
        f'<joint name="hub" type="hinge" axis="0 0 1" damping="{motor.viscous_friction_nm_s_per_rad}" '
        f'frictionloss="{max(dry, 1e-9)}" solreffriction="0.001 1" {spring} {limits}/>'
    )


def _on_hub(motor: Numbers) -> str:
    parts = []
    there = motor.added_from_s < NEVER_S or motor.gravity_from_s == 0.0
    if motor.gravity_torque_nm > 0.0 and there and not (hangs(motor) and motor.added_from_s >= NEVER_S):
        weight_nm = motor.gravity_torque_nm / GRAVITY_M_PER_S2
        arm_m = motor.added_inertia_kg_m2 / weight_nm if hangs(motor) else ARM_M
        parts.append(_ball(arm_m, motor.gravity_phase_rad - 0.5 * math.pi, weight_nm / arm_m))
    if motor.stranger == SWINGING_MASS:
        parts.append(_swinging(motor))
    if motor.stranger == ROLLING_BALLAST:
        parts.append(
            f'<body><joint name="slot" type="slide" axis="1 0 0" limited="true" range="{-motor.b} {motor.b}" '
            f'damping="0.05" solreflimit="0.008 0.5"/><inertial pos="0 0 0" mass="{motor.a}" '
            f'diaginertia="1e-6 1e-6 1e-6"/></body>'
        )
    if motor.stranger == SPRUNG_BUMP:
        parts.append('<geom type="sphere" size="0.006" pos="0.05 0 0" mass="0" contype="1" conaffinity="1"/>')
    return "\n      ".join(parts)


def _ball(radius_m: float, angle_rad: float, mass_kg: float) -> str:
    x_m, y_m = radius_m * math.cos(angle_rad), radius_m * math.sin(angle_rad)
    return f'<body pos="{x_m} {y_m} 0"><inertial pos="0 0 0" mass="{mass_kg}" diaginertia="1e-9 1e-9 1e-9"/></body>'


def _swinging(motor: Numbers) -> str:
    """A bob that swings freely from a pin on the hub: `a` its mass, `b` the pin's radius, `c` its length."""
    return (
        f'<body pos="{motor.b} 0 0"><joint name="pin" type="hinge" axis="0 0 1" damping="{motor.d}"/>'
        f'<inertial pos="0 {-motor.c} 0" mass="{motor.a}" diaginertia="1e-6 1e-6 1e-6"/></body>'
    )


def _beside(motor: Numbers) -> str:
    parts = []
    if motor.load_inertia_kg_m2 > 0.0:
        loss = max(motor.share * motor.coulomb_nm, 1e-9)
        parts.append(_coaxial("load", motor.load_inertia_kg_m2, loss))
    if motor.presliding_rad > 0.0:
        parts.append(_coaxial("bristle", BRISTLE_SHARE * motor.inertia_kg_m2, motor.coulomb_nm))
    if motor.stranger == SPRUNG_BUMP:
        parts.append(
            '<body pos="0.058 0 0"><joint name="bump" type="slide" axis="1 0 0" damping="0.6" '
            f'stiffness="{motor.a}" limited="true" range="-0.001 0.03"/>'
            '<geom type="sphere" size="0.008" mass="0.004" contype="1" conaffinity="1" '
            'solref="0.004 1" friction="0.2 0 0"/></body>'
        )
    return "\n    ".join(parts)


def _coaxial(name: str, inertia_kg_m2: float, loss_nm: float) -> str:
    return (
        f'<body><joint name="{name}" type="hinge" axis="0 0 1" frictionloss="{loss_nm}" solreffriction="0.001 1"/>'
        f'<inertial pos="0 0 0" mass="0.01" diaginertia="{_thrice(inertia_kg_m2)}"/></body>'
    )


def _tendons(motor: Numbers) -> str:
    parts = []
    if motor.load_inertia_kg_m2 > 0.0 and motor.gap_rad > 0.0:
        half = 0.5 * motor.gap_rad
        play = f'limited="true" range="{-half} {half}" solreflimit="0.004 0.8"'
        parts.append(_fixed("play", "load", play))
    elif motor.load_inertia_kg_m2 > 0.0:
        spring = f'stiffness="{motor.shaft_stiffness_nm_per_rad}" springlength="0"'
        parts.append(_fixed("shaft", "load", f'{spring} damping="{motor.shaft_damping_nm_s_per_rad}"'))
    if motor.presliding_rad > 0.0:
        stiffness = motor.coulomb_nm / motor.presliding_rad
        damping = 0.2 * math.sqrt(stiffness * motor.inertia_kg_m2)
        parts.append(
            _fixed("bristles", "bristle", f'stiffness="{stiffness}" springlength="0" damping="{damping}"')
        )
    if motor.stranger == SLACK_ROPE:
        rope = f'stiffness="{motor.a}" springlength="{motor.b} {motor.c}" damping="{motor.d}"'
        parts.append(f'<fixed name="rope" {rope}><joint joint="hub" coef="1"/></fixed>')
    return f"<tendon>{''.join(parts)}</tendon>" if parts else ""


def _fixed(name: str, other: str, keys: str) -> str:
    return (
        f'<fixed name="{name}" {keys}><joint joint="hub" coef="1"/><joint joint="{other}" coef="-1"/></fixed>'
    )


def _thrice(value: float) -> str:
    return f"{value} {value} {value}"
