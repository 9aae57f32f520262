"""The machine of this family, and the physics in nobody's library that its bodies make."""

from __future__ import annotations

import math
from importlib.util import find_spec
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.blind.families.compiled import as_record
from nxt_twin.blind.families.machine import Machine
from nxt_twin.blind.families.mujoco import electric, model
from nxt_twin.blind.families.numbers import NEVER_S, Numbers
from nxt_twin.blind.families.setting import DrawnCase, HiddenEffect, Hideable

HUB: Final = 1
VARYING: Final = (
    "stiction_excess_nm",
    "friction_per_torque",
    "cold_extra_torque_nm",
    "binding_torque_nm",
)


def ready() -> str:
    """Why MuJoCo cannot be used here; empty where it can."""
    return "" if find_spec("mujoco") else "the package mujoco is not installed"


@final
class MuJoCo(Machine):
    """A motor at rest at `start_rad`, and whatever is on it at rest with it."""

    def __init__(self, motor: Numbers, start_rad: float, begins_s: float = 0.0) -> None:
        import mujoco

        self._engine = mujoco
        self._motor, self._numbers = motor, as_record(motor)
        self._model = mujoco.MjModel.from_xml_string(model.motor_mjcf(motor))
        self._data = mujoco.MjData(self._model)
        self._turn_to(start_rad)
        self._x = np.zeros(electric.SLOTS)
        self._x[electric.VOLTS] = motor.supply_v
        self._now_s = begins_s
        self._varies = motor.coulomb_forward_nm != motor.coulomb_reverse_nm or any(
            getattr(motor, name) for name in VARYING
        )
        self._onset_s = NEVER_S if model.hangs(motor) else motor.added_from_s

    def _turn_to(self, start_rad: float) -> None:
        for name in ("hub", "load", "bristle"):
            joint = self._engine.mj_name2id(self._model, self._engine.mjtObj.mjOBJ_JOINT, name)
            if joint >= 0:
                self._data.qpos[self._model.jnt_qposadr[joint]] = start_rad
        self._engine.mj_forward(self._model, self._data)

    def run(self, stops_s: FloatArray, duty: float, mode: int) -> FloatArray:
        """As `Machine.run`."""
        out = np.zeros((stops_s.size, 3))
        for row, stop_s in enumerate(stops_s):
            span_s = float(stop_s) - self._now_s
            steps = max(0, math.ceil(span_s / model.LONGEST_STEP_S - 1e-6))
            if steps:
                self._model.opt.timestep = span_s / steps
                self._steps(steps, span_s / steps, duty, mode)
            self._now_s = float(stop_s)
            out[row] = self._data.qpos[0], self._x[electric.MISCOUNT], self._x[electric.VOLTS]
        return out

    def _steps(self, count: int, step_s: float, duty: float, mode: int) -> None:
        data, x, numbers, mj_step = self._data, self._x, self._numbers, self._engine.mj_step
        qpos, qvel, applied = data.qpos, data.qvel, data.qfrc_applied
        now_s = self._now_s
        for _ in range(count):
            if now_s >= self._onset_s:
                self._put_on(self._motor.added_inertia_kg_m2)
            applied[0] = electric.govern(numbers, now_s, step_s, qpos, qvel, x, duty, mode)
            if self._varies:
                self._rub(now_s)
            mj_step(self._model, data)
            now_s += step_s

    def _put_on(self, inertia_kg_m2: float) -> None:
        """Add to the hub's inertia; of a body that only turns, MuJoCo keeps a sum of its own."""
        self._model.body_inertia[HUB] += inertia_kg_m2
        self._model.dof_M0[0] += inertia_kg_m2
        self._onset_s = NEVER_S

    def _rub(self, now_s: float) -> None:
        """Set the joint's friction for the next step; a second inertia bears its share of it."""
        data, motor = self._data, self._motor
        drive_nm = abs(motor.torque_constant_nm_per_a * self._x[electric.CURRENT])
        level = electric.friction_loss(
            self._numbers,
            now_s,
            data.qpos[0],
            data.qvel[0],
            drive_nm,
            data.qfrc_applied[0] + data.qfrc_passive[0],
        )
        rubbing = 1 if motor.presliding_rad > 0.0 and motor.load_inertia_kg_m2 == 0.0 else 0
        self._model.dof_frictionloss[rubbing] = max(level - motor.share * motor.coulomb_nm, 1e-9)


def _swinging_mass(at: DrawnCase) -> HiddenEffect:
    torque = at.torque(small=(0.01, 0.015), medium=(0.025, 0.04), large=(0.06, 0.09))
    pin_m, length_m = at.between(0.03, 0.05), at.between(0.04, 0.1)
    mass_kg = torque / (model.GRAVITY_M_PER_S2 * pin_m)
    return _strange(model.SWINGING_MASS, a=mass_kg, b=pin_m, c=length_m, d=mass_kg * length_m**2 * 0.8)


def _slack_rope(at: DrawnCase) -> HiddenEffect:
    stiffness = at.torque(small=(4e-3, 7e-3), medium=(0.012, 0.02), large=(0.04, 0.08))
    width = at.between(1.0, 4.0)
    middle = math.radians(float(np.mean(at.starts_deg))) + float(at.rng.uniform(-0.5, 0.5))
    damping = 0.05 * math.sqrt(stiffness * at.motor.inertia_kg_m2)
    return _strange(model.SLACK_ROPE, a=stiffness, b=middle - width, c=middle + width, d=damping)


def _sprung_bump(at: DrawnCase) -> HiddenEffect:
    return _strange(
        model.SPRUNG_BUMP, a=at.among(small=(40.0, 60.0), medium=(100.0, 150.0), large=(250.0, 400.0))
    )


def _rolling_ballast(at: DrawnCase) -> HiddenEffect:
    torque = at.torque(small=(0.01, 0.015), medium=(0.025, 0.04), large=(0.06, 0.09))
    room_m = at.between(0.03, 0.06)
    return _strange(model.ROLLING_BALLAST, a=torque / (model.GRAVITY_M_PER_S2 * room_m), b=room_m)


def _strange(kind: int, **numbers: float) -> HiddenEffect:
    return HiddenEffect(numbers, {"stranger": float(kind), **numbers})


STRANGERS: Final = (
    Hideable("swinging_mass", "kinematic", _swinging_mass, known=False),
    Hideable("slack_rope", "torque_balance", _slack_rope, known=False),
    Hideable("sprung_bump", "torque_balance", _sprung_bump, known=False),
    Hideable("rolling_ballast", "kinematic", _rolling_ballast, known=False),
)
"""One in a case."""
