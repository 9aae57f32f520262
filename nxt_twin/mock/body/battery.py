"""The battery: an open-circuit voltage that drains, behind an internal resistance."""

from __future__ import annotations

from typing import Final, final

IDLE_CURRENT_A: Final = 0.06
"""What the brick's electronics draw."""
DEFAULT_VOLTAGE_V: Final = 8.2
DEFAULT_RESISTANCE_OHM: Final = 0.35
"""Six alkaline cells and the contacts between them."""
DEFAULT_DRAIN_V_PER_C: Final = 2.4 / 7200.0
"""From 9.0 V to 6.6 V over 2000 mAh."""


@final
class Battery:
    """Six cells in series.

    Args:
        voltage_v: the open-circuit voltage to start with, V.
        resistance_ohm: the internal resistance, Ω.
        drain_v_per_c: by how much the open-circuit voltage falls for each coulomb drawn, V/C.
    """

    def __init__(
        self,
        voltage_v: float = DEFAULT_VOLTAGE_V,
        resistance_ohm: float = DEFAULT_RESISTANCE_OHM,
        drain_v_per_c: float = DEFAULT_DRAIN_V_PER_C,
    ) -> None:
        self.open_circuit_v = voltage_v
        self.resistance_ohm = resistance_ohm
        self._drain_v_per_c = drain_v_per_c
        self.terminal_v = voltage_v

    def draw(self, motor_current_a: float, duration_s: float) -> None:
        """Deliver the motors' current, and the brick's own, for a while."""
        current_a = max(0.0, motor_current_a) + IDLE_CURRENT_A
        self.open_circuit_v = max(0.0, self.open_circuit_v - current_a * duration_s * self._drain_v_per_c)
        self.terminal_v = max(0.0, self.open_circuit_v - current_a * self.resistance_ohm)
