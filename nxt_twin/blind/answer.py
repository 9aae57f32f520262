"""The sealed answer to a case."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.blind.case import NOMINAL, rms
from nxt_twin.blind.conceal import ConcealedMotor
from nxt_twin.blind.record import Taken
from nxt_twin.blind.truth.motor import Motor
from nxt_twin.blind.truth.run import Commands, true_run
from nxt_twin.blind.truth.sensing import Sensing

ANSWER_SCHEMA: Final = "nxt-twin/answer/1"


def encoded(answer: Mapping[str, Any]) -> bytes:
    """The answer as it is written and sealed."""
    return json.dumps(answer).encode()


def seal(answer: bytes) -> str:
    """The SHA-256 of an encoded answer, in hexadecimal."""
    return hashlib.sha256(answer).hexdigest()


def true_parameters(motor: Motor) -> dict[str, float]:
    """The true values of the baseline's keys."""
    other = {
        "coulomb_friction_nm": 0.5 * (motor.coulomb_forward_nm + motor.coulomb_reverse_nm),
        "supply_v": motor.battery_v,
    }
    return {key: other[key] if key in other else float(getattr(motor, key)) for key in NOMINAL}


def truth_of_recordings(
    hidden: ConcealedMotor, commands: Sequence[Commands], families: Sequence[str], taken: Sequence[Taken]
) -> dict[str, Any]:
    """The true angle of each recording, and by how much (RMS) the effects moved the encoder's reading."""
    shifts_deg = [_shift_deg(hidden, *pair) for pair in zip(commands, taken, strict=True)]
    recordings = {
        one.recording.name: {
            "family": family,
            "effect_rms_deg": rms(shift_deg),
            "hub_deg": [round(float(angle), 3) for angle in one.hub_deg],
        }
        for family, one, shift_deg in zip(families, taken, shifts_deg, strict=True)
    }
    return {"effect_rms_deg": rms(np.concatenate(shifts_deg)), "recordings": recordings}


def _shift_deg(hidden: ConcealedMotor, commands: Commands, taken: Taken) -> FloatArray:
    """Reading with the effects minus reading of the same motor without them, at the stamps."""
    if not hidden.effects:
        return np.zeros(taken.read_deg.size)
    plain = true_run(hidden.plain, Sensing(), commands)
    return taken.read_deg - np.interp(taken.recording.time_s, plain.stamp_s, plain.encoder_deg)
