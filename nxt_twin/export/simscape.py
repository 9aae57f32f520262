"""A motor as the parameters of Simscape's blocks, one a row, under the names that the blocks' dialogs show."""

from __future__ import annotations

import csv
import io

from nxt_twin.export.axis import Axis


def simscape_csv(axis: Axis, told: tuple[str, ...]) -> str:
    """Columns block, parameter, value, unit; lines that start with # are remarks."""
    motor, friction, source = "DC Motor", "Rotational Friction", "DC Voltage Source"
    rows: list[tuple[str, str, float | str, str]] = [
        (motor, "Model parameterization", "By equivalent circuit parameters", ""),
        (motor, "Armature resistance", axis.resistance_ohm, "Ohm"),
        (motor, "Armature inductance", axis.inductance_h, "H"),
        (motor, "Back-emf constant", axis.back_emf_v_s_per_rad, "V/(rad/s)"),
        (motor, "Torque constant", axis.torque_constant_nm_per_a, "N*m/A"),
        (motor, "Rotor inertia", axis.inertia_kg_m2, "kg*m^2"),
        (motor, "Rotor damping", 0.0, "N*m/(rad/s)"),
        (friction, "Breakaway friction torque", axis.coulomb_friction_nm, "N*m"),
        (friction, "Coulomb friction torque", axis.coulomb_friction_nm, "N*m"),
        (friction, "Viscous friction coefficient", axis.viscous_friction_nm_s_per_rad, "N*m/(rad/s)"),
        (source, "Constant voltage", axis.supply_v, "V"),
    ]
    text = io.StringIO()
    text.writelines(f"# {line}\n" for line in told)
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("block", "parameter", "value", "unit"))
    writer.writerows(rows)
    return text.getvalue()
