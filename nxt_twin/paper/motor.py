"""Section II recomputed: torque constant, static friction, viscous friction."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

import numpy as np
from scipy.optimize import minimize_scalar

from nxt_twin.arrays import FloatArray
from nxt_twin.paper import printed
from nxt_twin.paper.finding import Comparison, Contradiction, compare_printed, powers

SUPPLY_V = 9.0
"""The highest voltage of the speeds behind equation 5 is not printed; six fresh cells give this."""

_GEAR_RATIO = 48.0
_VOLTAGES = 1000


@final
@dataclass(frozen=True)
class MotorNumbers:
    """Everything of section II that follows from what the paper prints.

    Attributes:
        speed_rad_per_s: Table I's speeds, from its revolutions per minute.
        emf_per_speed: V·s/rad, without rest.
        ks_slope: of the line with an offset, V·s/rad.
        ks_offset_v: where that line meets rest, V.
        ks: of the line through the origin, V·s/rad.
        stall_v: at which equation 5 meets rest, V.
        static_friction_nm: equation 6.
        viscous: N·m·s/rad, by least absolute error of equation 11 with that static friction.
        viscous_with_printed: the same with the static friction that is printed.
    """

    speed_rad_per_s: FloatArray
    emf_per_speed: FloatArray
    ks_slope: float
    ks_offset_v: float
    ks: float
    stall_v: float
    static_friction_nm: float
    viscous: float
    viscous_with_printed: float


def motor_numbers() -> MotorNumbers:
    """Recompute section II."""
    speed = printed.SPEED_RPM * (2.0 * math.pi / 60.0)
    slope, offset = np.polyfit(speed, printed.EMF_V, 1)
    stall_v = printed.LINE_OFFSET / printed.LINE_SLOPE
    static = printed.KS * stall_v / printed.RESISTANCE_OHM
    return MotorNumbers(
        speed_rad_per_s=speed,
        emf_per_speed=printed.EMF_V[1:] / speed[1:],
        ks_slope=float(slope),
        ks_offset_v=float(offset),
        ks=float(speed @ printed.EMF_V / (speed @ speed)),
        stall_v=stall_v,
        static_friction_nm=static,
        viscous=_least_absolute(static),
        viscous_with_printed=_least_absolute(printed.STATIC_FRICTION_NM),
    )


def line_speed(voltage_v: FloatArray) -> FloatArray:
    """Equation 5: the measured speed, rad/s, as a line in the voltage, V."""
    return printed.LINE_SLOPE * voltage_v - printed.LINE_OFFSET


def model_speed(voltage_v: FloatArray, static_nm: float, viscous: float) -> FloatArray:
    """Equation 11: the model's speed, rad/s, at a voltage, V."""
    lost_v = printed.RESISTANCE_OHM * static_nm / printed.KS
    return (voltage_v - lost_v) / (printed.RESISTANCE_OHM * viscous / printed.KS + printed.KS)


def voltages_v() -> FloatArray:
    """The voltages over which errors are summed, from the one at which it begins to turn, V."""
    stall_v = printed.LINE_OFFSET / printed.LINE_SLOPE
    return np.linspace(stall_v, SUPPLY_V, _VOLTAGES)


def mean_absolute_error(static_nm: float, viscous: float) -> float:
    """Between equations 11 and 5, over `voltages_v`, rad/s."""
    voltage = voltages_v()
    return float(np.mean(np.abs(model_speed(voltage, static_nm, viscous) - line_speed(voltage))))


def _least_absolute(static_nm: float) -> float:
    best = minimize_scalar(
        lambda viscous: mean_absolute_error(static_nm, viscous),
        bounds=(0.0, 0.02),
        method="bounded",
        options={"xatol": 1e-9},
    )
    return float(best.x)


def compare_motor(numbers: MotorNumbers) -> list[Comparison]:
    """Section II's numbers, one by one."""
    listed = [
        compare_printed(f"speed at {rpm:.0f} rev/min", "Table I", "rad/s", f"{shown:.2f}", speed)
        for rpm, shown, speed in zip(
            printed.SPEED_RPM[1:],
            printed.SPEED_RAD_PER_S[1:],
            numbers.speed_rad_per_s[1:].tolist(),
            strict=True,
        )
    ]
    listed += [
        compare_printed(f"emf over speed at {rpm:.0f} rev/min", "Table I", "V·s/rad", f"{shown:.3f}", ratio)
        for rpm, shown, ratio in zip(
            printed.SPEED_RPM[1:], printed.EMF_PER_SPEED, numbers.emf_per_speed.tolist(), strict=True
        )
    ]
    return [
        *listed,
        compare_printed("Ks, line with an offset", "II-1", "V·s/rad", "0.4919", numbers.ks_slope),
        compare_printed("offset of that line", "II-1", "V", "0.0218", abs(numbers.ks_offset_v)),
        compare_printed("Ks, line through the origin", "Table II", "V·s/rad", "0.4908", numbers.ks),
        compare_printed(
            "static friction Tc by equation 6", "Table II", "N·m", "3.558e-4", numbers.static_friction_nm
        ),
        compare_printed(
            "viscous friction B, with that Tc", "Table II", "N·m·s/rad", "1.92e-3", numbers.viscous
        ),
        compare_printed(
            "viscous friction B, with the printed Tc",
            "Table II",
            "N·m·s/rad",
            "1.92e-3",
            numbers.viscous_with_printed,
        ),
    ]


def motor_contradictions(numbers: MotorNumbers) -> list[Contradiction]:
    """Where section II disagrees with itself."""
    return [_static(numbers), _viscous(numbers), _ratios(numbers), _average(numbers), _unit(), _symbol()]


def _static(numbers: MotorNumbers) -> Contradiction:
    current = numbers.stall_v / printed.RESISTANCE_OHM / _GEAR_RATIO
    factor = numbers.static_friction_nm / printed.STATIC_FRICTION_NM
    return Contradiction(
        id="static_friction",
        title=f"The static friction is printed {factor:.0f} times too small",
        where="equations 5 and 6, Table II",
        claim=f"the torque of static friction is {powers(printed.STATIC_FRICTION_NM, 3)} N·m",
        evidence=f"equation 5 is at rest at {numbers.stall_v:.4f} V, for which equation 6 gives"
        f" {powers(numbers.static_friction_nm, 3)} N·m, {factor:.1f} times as much",
        cause="our guess, which nothing in the text confirms: a current was taken for the torque. The stall current"
        f" over the gear ratio, v_c / (48 R_a), is {powers(current, 3)} A. One digit differs from the printed number,"
        " as if K_s had been left out and the digit misread",
        used=f"{powers(numbers.static_friction_nm, 3)} N·m",
    )


def _viscous(numbers: MotorNumbers) -> Contradiction:
    own = mean_absolute_error(printed.STATIC_FRICTION_NM, printed.VISCOUS_FRICTION_NM_S_PER_RAD)
    mended = mean_absolute_error(numbers.static_friction_nm, printed.VISCOUS_FRICTION_NM_S_PER_RAD)
    apart = abs(printed.VISCOUS_FRICTION_NM_S_PER_RAD / numbers.viscous - 1.0)
    return Contradiction(
        id="viscous_friction_against_static",
        title="The viscous friction does not go with the static friction of the same table",
        where="equation 11, Table II",
        claim="B = 1.92E-3 N·m·s/rad has the least absolute error in equation 11 with Table II's T_c",
        evidence=f"errors are means against equation 5, to {SUPPLY_V:.0f} V. With the printed T_c the error is least at"
        f" B = {powers(numbers.viscous_with_printed, 2)}; the printed B errs by {own:.3f} rad/s."
        f" With T_c of equation 6 it is least at B = {powers(numbers.viscous, 3)}; the printed B errs by"
        f" {mended:.3f} rad/s",
        cause="B was fitted with the right T_c, to the measured speeds behind equation 5, which are not printed."
        f" It is {apart:.1%} from the value that the line gives. Only T_c was printed wrongly",
        used="1.92e-3 N·m·s/rad, with T_c of equation 6",
    )


def _ratios(numbers: MotorNumbers) -> Contradiction:
    wrong = [
        f"{shown:.3f} for {ratio:.4f}"
        for shown, ratio in zip(printed.EMF_PER_SPEED, numbers.emf_per_speed, strict=True)
        if round(float(ratio), 3) != shown
    ]
    return Contradiction(
        id="table_1_rounding",
        title="Some cells of Table I are cut off, others rounded",
        where="Table I",
        claim="the last column is e over the speed",
        evidence=f"it prints {', '.join(wrong)}; and 24.39 rad/s for 233 rev/min, which is"
        f" {numbers.speed_rad_per_s[5]:.3f}",
        cause="digits were cut off in some cells and rounded in others",
        used="the speeds in rev/min and the voltages",
    )


def _average(numbers: MotorNumbers) -> Contradiction:
    mean = float(np.mean(printed.EMF_PER_SPEED))
    return Contradiction(
        id="average_of_ks",
        title="The average of K_s is not the number that is called so",
        where="II-1, below Table I",
        claim="the average value for K_s is about 0.4919",
        evidence=f"Table I's six values average {mean:.4f} ({np.mean(numbers.emf_per_speed):.4f} unrounded); 0.4919 is"
        f" the slope of the line with an offset ({numbers.ks_slope:.4f})",
        cause="slope and average are different things; the text says both of one number",
        used=f"the slope through the origin, {printed.KS}",
    )


def _unit() -> Contradiction:
    return Contradiction(
        id="unit_of_ks",
        title="The unit of K_s is multiplied where it has to be divided",
        where="II-1, below Table I",
        claim="K_s is in V.rad/s",
        evidence="equation 3, e = K_s ω, makes it V·s/rad, which equals N·m/A as equation 2 asks",
        cause="the unit of the speed was multiplied instead of divided by",
        used="V·s/rad",
    )


def _symbol() -> Contradiction:
    slope_rpm = printed.LINE_SLOPE * 60.0 / (2.0 * math.pi)
    return Contradiction(
        id="symbol_of_equation_5",
        title="The speed in equation 5 is named as if it were in rev/min",
        where="equation 5",
        claim="rot = 1.9248 v - 0.2519, rot being Table I's symbol of which one column is in rev/min",
        evidence="the text below the equation means ω in rad/s, and only that unit fits. Without friction the slope"
        f" would be 1 / K_s = {1.0 / printed.KS:.4f} rad/s per V. 1.9248 rad/s per V is {slope_rpm:.2f} rev/min per V",
        cause="a label taken over from the plot",
        used="rad/s",
    )
