"""What somebody may do to a motor between two recordings, and how an answer may name it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final


@final
@dataclass(frozen=True)
class MotorTouch:
    """One thing that changes.

    Attributes:
        id: as the sealed answer names it.
        names: the parameter or effect that an answer has to name; one of them is enough.
        effect: id of an effect that it is about.
        scales: fields of a true motor that are multiplied after; a family has one of their names.
        factors: between which they are multiplied, or divided where it goes `either` way.
        either: whether the numbers may fall as well as rise.
        before: whether the effect acts before too, and only `scales` change.
        companions: what an answer may name besides: an arm has inertia.
        battery_unread: whether nobody reads the battery.
    """

    id: str
    names: frozenset[str]
    effect: str | None = None
    scales: tuple[str, ...] = ()
    factors: tuple[float, float] = (1.0, 1.0)
    either: bool = True
    before: bool = False
    companions: frozenset[str] = frozenset()
    battery_unread: bool = False


def _new(effect: str, *companions: str) -> MotorTouch:
    return MotorTouch(effect, frozenset({effect}), effect, companions=frozenset(companions))


_COULOMB = ("coulomb_forward_nm", "coulomb_reverse_nm")

TOUCHES: Final[dict[str, MotorTouch]] = {
    touch.id: touch
    for touch in (
        MotorTouch("inertia", frozenset({"inertia_kg_m2"}), scales=("inertia_kg_m2",), factors=(1.4, 2.5)),
        MotorTouch(
            "coulomb_friction",
            frozenset({"coulomb_friction_nm"}),
            scales=_COULOMB,
            factors=(2.0, 4.0),
            either=False,
        ),
        MotorTouch(
            "viscous_friction",
            frozenset({"viscous_friction_nm_s_per_rad"}),
            scales=("viscous_friction_nm_s_per_rad",),
            factors=(1.8, 3.5),
            either=False,
        ),
        MotorTouch(
            "supply",
            frozenset({"supply_v"}),
            scales=("battery_v", "supply_v"),
            factors=(1.12, 1.3),
            battery_unread=True,
        ),
        MotorTouch(
            "gravity",
            frozenset({"gravity_torque_nm"}),
            "gravity_load",
            scales=("arm_mass_kg", "gravity_torque_nm"),
            factors=(1.5, 2.5),
            before=True,
            companions=frozenset({"inertia_kg_m2"}),
        ),
        MotorTouch(
            "spring",
            frozenset({"stiffness_nm_per_rad"}),
            "spring_load",
            scales=("band_stiffness_nm_per_rad", "spring_nm_per_rad"),
            factors=(1.5, 2.5),
            before=True,
        ),
        _new("gravity_load", "inertia_kg_m2"),
        _new("spring_load"),
        _new("constant_load"),
        _new("battery_sag"),
        _new("backlash"),
        _new("stiction"),
        _new("quadratic_drag"),
        _new("command_delay"),
    )
}  # fmt: skip
"""All of them; effects come in medium and large sizes."""


def stand_together(one: MotorTouch, other: MotorTouch) -> bool:
    """Whether both can be done at once, and told apart afterwards."""
    friction = {"coulomb_friction", "stiction"}
    both = {one.id, other.id}
    return one.id != other.id and (one.effect or one.id) != (other.effect or other.id) and both != friction
