"""What of a plant other programs can take over: one geared DC motor, its friction, and the names of the rest."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, final

from nxt_twin.errors import PlantError
from nxt_twin.physics.plant import Plant

_KIND: Final = "dc_motor"
_CARRIED: Final = frozenset({"coulomb_friction", "viscous_friction", "inductance"})


@final
@dataclass(frozen=True)
class Axis:
    """A motor at its output hub, SI units.

    Attributes:
        name: of letters, digits and underscores.
        effects: ids of effects that no format carries.
    """

    name: str
    inertia_kg_m2: float
    resistance_ohm: float
    inductance_h: float
    torque_constant_nm_per_a: float
    back_emf_v_s_per_rad: float
    coulomb_friction_nm: float
    viscous_friction_nm_s_per_rad: float
    supply_v: float
    effects: tuple[str, ...] = ()

    @property
    def stall_torque_nm(self) -> float:
        """The torque at rest with the whole supply, before friction."""
        return self.torque_constant_nm_per_a * self.supply_v / self.resistance_ohm

    @property
    def free_speed_rad_per_s(self) -> float:
        """The speed at which the whole supply holds the motor against its own friction."""
        gain = self.torque_constant_nm_per_a / self.resistance_ohm
        losses = self.viscous_friction_nm_s_per_rad + gain * self.back_emf_v_s_per_rad
        return max(0.0, self.stall_torque_nm - self.coulomb_friction_nm) / losses


def check_kind(config: Mapping[str, Any], name: str) -> None:
    """Refuse a plant that no format carries, by its keys.

    Raises:
        PlantError: it is of another kind than dc_motor.
    """
    if config.get("kind") != _KIND:
        mend = f"only a plant of kind {_KIND} can be exported"
        raise PlantError(f"is of kind {config.get('kind')}", where=name, mend=mend)


def axis_of(plant: Plant, name: str) -> Axis:
    """The axis of a plant.

    Args:
        plant: of kind dc_motor.
        name: what to call it; other characters than letters, digits and underscores become underscores.

    Raises:
        PlantError: it is of another kind.
    """
    config = plant.to_config()
    check_kind(config, name)
    return Axis(
        name=re.sub(r"\W", "_", name) or "motor",
        supply_v=config["supply_v"],
        effects=tuple(effect.id for effect in plant.effects if effect.id not in _CARRIED),
        **{key: _number(config, key) for key in _NUMBERS},
    )


_NUMBERS: Final = (
    "inertia_kg_m2",
    "resistance_ohm",
    "inductance_h",
    "torque_constant_nm_per_a",
    "back_emf_v_s_per_rad",
    "coulomb_friction_nm",
    "viscous_friction_nm_s_per_rad",
)


def _number(config: Mapping[str, Any], key: str) -> float:
    """A value of the plant file; physics that it leaves out is 0."""
    return float(config.get(key, 0.0))


def written(value: float) -> str:
    """A number as the formats write it: nine digits, more than any parameter has."""
    return f"{value:.9g}"
