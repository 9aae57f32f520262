"""The true robot's numbers, all in SI units; nothing of it is shared with the diagnosis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True)
class TrueRobot:
    """A rigid body on two driven wheels and a caster.

    Attributes:
        left_radius_m, right_radius_m, track_m: the wheels.
        mass_kg: of the body with its payload.
        spin_kg_m2: inertia about the vertical through its centre of mass.
        ahead_m, aside_m: centre of mass from the axle's middle, forward and to the left.
        caster_back_m: the caster behind the axle.
        caster_drag_n: its friction on the floor, against its motion.
        slope_rad, uphill_rad: of the floor, and the heading that points uphill.
        resistance_ohm, back_emf_v_s, dry_nm, wet_nm_s, rotor_kg_m2: of the left and the right motor.
        uneven_nm: what dry friction of each motor has more forward, and less in reverse.
        fan_nm_s2: drag of each motor by the square of its rate.
        brush_v: voltage that the brushes of each motor take from the current.
        cells_ohm, cells_v: internal resistance and open-circuit voltage of the battery.
        patch_drag_n: drag where x is above `patch_from_m`, which no library holds.
        tether_n_per_m: pull of a cable towards the start, which no library holds.
        nap: travel across that the floor adds in one direction, which no library holds.
        scrub: growth of the track with the turning rate, s/rad, which no library holds.
    """

    left_radius_m: float = 0.028
    right_radius_m: float = 0.028
    track_m: float = 0.12
    mass_kg: float = 1.0
    spin_kg_m2: float = 0.005
    ahead_m: float = 0.0
    aside_m: float = 0.0
    caster_back_m: float = 0.09
    caster_drag_n: float = 0.0
    slope_rad: float = 0.0
    uphill_rad: float = 0.0
    resistance_ohm: tuple[float, float] = (7.6, 7.6)
    back_emf_v_s: tuple[float, float] = (0.49, 0.49)
    dry_nm: tuple[float, float] = (8.45e-3, 8.45e-3)
    wet_nm_s: tuple[float, float] = (1.9e-3, 1.9e-3)
    rotor_kg_m2: tuple[float, float] = (1.2e-3, 1.2e-3)
    patch_drag_n: float = 0.0
    patch_from_m: float = 0.3
    tether_n_per_m: float = 0.0
    nap: float = 0.0
    scrub: float = 0.0
    uneven_nm: tuple[float, float] = (0.0, 0.0)
    fan_nm_s2: tuple[float, float] = (0.0, 0.0)
    brush_v: tuple[float, float] = (0.0, 0.0)
    cells_ohm: float = 0.0
    cells_v: float = 8.0

    def packed(self) -> tuple[float, ...]:
        """All numbers in the order that the integrator reads."""
        return (
            self.left_radius_m, self.right_radius_m, self.track_m, self.mass_kg, self.spin_kg_m2, self.ahead_m,
            self.aside_m, self.caster_back_m, self.caster_drag_n, self.slope_rad, self.uphill_rad,
            *self.resistance_ohm, *self.back_emf_v_s, *self.dry_nm, *self.wet_nm_s, *self.rotor_kg_m2,
            self.patch_drag_n, self.patch_from_m, self.tether_n_per_m, self.nap, self.scrub,
            *self.uneven_nm, *self.fan_nm_s2, *self.brush_v, self.cells_ohm, self.cells_v,
        )  # fmt: skip
