"""The source paper's figures that its tables and numbers allow to draw: 6, 7, 8, 9 and 14."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from nxt_twin.arrays import FloatArray
from nxt_twin.paper import printed
from nxt_twin.paper.motor import SUPPLY_V, MotorNumbers, line_speed, model_speed, voltages_v
from nxt_twin.view import palette
from nxt_twin.view.legends import name_all_curves
from nxt_twin.view.paper_axes import draw, pair

_CURRENT_LIMIT_A = 1.0
"""Figure 9 draws a limit of the current without a number; this one is for the picture."""


def emf_figure(numbers: MotorNumbers) -> Figure:
    """Figure 6: the voltage of the open motor against its speed, with both lines, and what they leave."""
    figure, (left, right) = pair()
    speed, voltage = numbers.speed_rad_per_s, printed.EMF_V
    lines = {
        f"with an offset: {numbers.ks_slope:.4f} ω − {abs(numbers.ks_offset_v):.4f}": (
            palette.BASELINE,
            numbers.ks_slope * speed + numbers.ks_offset_v,
        ),
        f"through the origin: {numbers.ks:.4f} ω": (palette.IMPROVED, numbers.ks * speed),
    }
    draw(left, "emf (V)", "speed (rad/s)")
    draw(right, "emf less line (V)", "speed (rad/s)")
    left.plot(speed, voltage, "o", color=palette.MEASURED_INK, markersize=4, label="Table I")
    for name, (colour, fitted) in lines.items():
        left.plot(speed, fitted, color=colour, linewidth=1.1, label=name)
        right.plot(speed, voltage - fitted, "o-", color=colour, linewidth=0.8, markersize=3.5)
    right.axhline(0.0, color=palette.LINE, linewidth=0.8)
    name_all_curves(figure)
    return figure


def models_figure(numbers: MotorNumbers) -> Figure:
    """Figures 7 and 8: speed against voltage by each model, and by how much it misses the measured line."""
    figure, (left, right) = pair()
    voltage = voltages_v()
    draw(left, "speed (rad/s)", "voltage (V)")
    draw(right, "speed of the model less that of the line (rad/s)", "voltage (V)")
    left.plot(
        voltage, line_speed(voltage), color=palette.MEASURED, linewidth=4, label="equation 5, measured line"
    )
    for name, colour, style, static, viscous in _models(numbers):
        speed = model_speed(voltage, static, viscous)
        left.plot(voltage, speed, color=colour, linestyle=style, linewidth=1.1, label=name)
        right.plot(voltage, speed - line_speed(voltage), color=colour, linestyle=style, linewidth=1.1)
    right.axhline(0.0, color=palette.LINE, linewidth=0.8)
    name_all_curves(figure)
    return figure


def _models(numbers: MotorNumbers) -> list[tuple[str, str, str, float, float]]:
    right, wrong = numbers.static_friction_nm, printed.STATIC_FRICTION_NM
    viscous = printed.VISCOUS_FRICTION_NM_S_PER_RAD
    return [
        ("no friction", palette.NOISE, "-", 0.0, 0.0),
        ("static friction of equation 6 only", palette.STALE, "-", right, 0.0),
        ("Table II as printed", palette.BASELINE, "-", wrong, viscous),
        ("Table II with equation 6", palette.IMPROVED, "-", right, viscous),
        ("B fitted anew to the line", palette.IMPROVED, ":", right, numbers.viscous),
    ]


def limits_figure() -> Figure:
    """Figure 9: the voltage is limited to the battery's, and the current by the driver."""
    figure, (left, right) = pair()
    wanted = np.linspace(-14.0, 14.0, 281)
    applied = np.clip(wanted, -SUPPLY_V, SUPPLY_V)
    draw(left, "voltage at the motor (V)", "voltage asked for (V)")
    left.plot(wanted, wanted, color=palette.NOISE, linewidth=1.1, label="no limit")
    left.plot(wanted, applied, color=palette.IMPROVED, linewidth=1.1, label=f"battery of {SUPPLY_V:.0f} V")
    draw(right, "torque at standstill (N·m)", "voltage asked for (V)")
    free = printed.KS * wanted / printed.RESISTANCE_OHM
    current = np.clip(applied / printed.RESISTANCE_OHM, -_CURRENT_LIMIT_A, _CURRENT_LIMIT_A)
    right.plot(wanted, free, color=palette.NOISE, linewidth=1.1, label="no limit")
    right.plot(
        wanted, printed.KS * applied / printed.RESISTANCE_OHM,
        color=palette.IMPROVED, linewidth=1.1, label="voltage limited",
    )  # fmt: skip
    right.plot(
        wanted, printed.KS * current,
        color=palette.BASELINE, linewidth=1.1, label=f"and current, to {_CURRENT_LIMIT_A:.0f} A",
    )  # fmt: skip
    name_all_curves(figure)
    return figure


def touch_figure() -> Figure:
    """Figure 14: the state of touch sensor 1 over a slow press and release, against force and against travel."""
    figure, (left, right) = pair()
    pairs = (
        (left, printed.FORCE_ON.samples, printed.FORCE_OFF.samples, "force (g)"),
        (right, printed.TRAVEL_ON.samples, printed.TRAVEL_OFF.samples, "travel (mm)"),
    )
    for axes, on, off, abscissa in pairs:
        draw(axes, "touch sensor 1: state", abscissa)
        press, release = float(on[0].mean()), float(off[0].mean())
        end = press + 3.0 * (press - release)
        start = release - 3.0 * (press - release)
        axes.plot(
            [start, press, press, end], [0, 0, 1, 1],
            color=palette.BASELINE, linewidth=1.3, label=f"pressing, on at {press:g}",
        )  # fmt: skip
        axes.plot(
            [end, release, release, start], [1, 1, 0, 0],
            color=palette.IMPROVED, linewidth=1.3, linestyle="--", label=f"releasing, off at {release:g}",
        )  # fmt: skip
        axes.set_yticks([0, 1])
        axes.set_ylim(-0.1, 1.25)
    name_all_curves(figure)
    return figure


def units_figure() -> Figure:
    """Force and travel at both state changes, each sensor by each: how much units differ."""
    figure, (left, right) = pair()
    for axes, on, off, ordinate in (
        (left, printed.FORCE_ON.samples, printed.FORCE_OFF.samples, "force (g)"),
        (right, printed.TRAVEL_ON.samples, printed.TRAVEL_OFF.samples, "travel (mm)"),
    ):
        draw(axes, ordinate, "sensor")
        _dots(axes, on, palette.BASELINE, "off to on")
        _dots(axes, off, palette.IMPROVED, "on to off")
        axes.set_xticks(range(1, 9))
    name_all_curves(figure)
    return figure


def _dots(axes: Axes, samples: FloatArray, colour: str, name: str) -> None:
    sensors = np.repeat(np.arange(1, samples.shape[0] + 1), samples.shape[1])
    axes.plot(
        sensors, samples.ravel(), "o", color=colour, markersize=5, alpha=0.35, markeredgewidth=0, label=name
    )
