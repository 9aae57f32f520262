"""Units in which people read positions, speeds and torques."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

from nxt_twin.physics.parameter import Frame
from nxt_twin.physics.signals import Signals


@final
@dataclass(frozen=True)
class Units:
    """Names of the units of a plant, and the factors from SI to them."""

    reading: str
    reading_factor: float
    position: str
    position_factor: float
    speed: str
    torque: str
    command: str
    command_factor: float


def units_of(frame: Frame, signals: Signals) -> Units:
    """The units in which to show `signals` of a plant in `frame`."""
    linear = frame == "linear"
    position, factor = ("mm", 1e3) if linear else ("deg", 180.0 / math.pi)
    commands = {
        "power_pct": ("power (%)", 100.0),
        "voltage_v": ("voltage (V)", 1.0),
        "current_a": ("current (A)", 1.0),
        "torque_nm": ("torque (N·m)", 1.0),
        "force_n": ("force (N)", 1.0),
        "goal_position_rad": ("goal (deg)", 180.0 / math.pi),
    }
    command, command_factor = commands[signals.input_kind]
    return Units(
        reading=f"{position}/s" if signals.is_speed else position,
        reading_factor=factor,
        position=position,
        position_factor=factor,
        speed="m/s" if linear else "rad/s",
        torque="N" if linear else "N·m",
        command=command,
        command_factor=command_factor,
    )


def after_number(unit: str) -> str:
    """The unit as it stands after a number, with a space; a ratio has none."""
    return "" if unit == "1" else f" {unit}"
