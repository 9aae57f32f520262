"""The sentences about a robot before and after."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from nxt_twin.diagnose.changed.answer import Change, ChangeVerdict
from nxt_twin.diagnose.diagnosis import Fit
from nxt_twin.diagnose.robot.effects import LIBRARY
from nxt_twin.diagnose.robot.leftover import RobotLeft
from nxt_twin.diagnose.robot.words import leftover_words, slip_words, untold_words
from nxt_twin.diagnose.robot_changed.side import RobotSide
from nxt_twin.diagnose.telling.words import listed
from nxt_twin.diagnose.units import after_number

_WORDS: Final = {
    "left_wheel_radius_m": "left wheel's radius",
    "right_wheel_radius_m": "right wheel's radius",
    "track_m": "track",
    "back_emf_v_s_per_rad": "back-EMF constant",
    "resistance_ohm": "resistance",
    "coulomb_friction_nm": "Coulomb friction",
    "viscous_friction_nm_s_per_rad": "viscous friction",
    "inertia_kg_m2": "inertia",
}
_LESS: Final = 1.02  # the error falls where it was more than this times as large without the changes
_UNITS: Final = {
    "back_emf_v_s_per_rad": "V·s/rad",
    "resistance_ohm": "Ω",
    "coulomb_friction_nm": "N·m",
    "viscous_friction_nm_s_per_rad": "N·m·s/rad",
    "inertia_kg_m2": "kg·m²",
}


def sentence(verdict: ChangeVerdict, changes: Sequence[Change], fit: Fit, names: tuple[str, str]) -> str:
    """What changed, and by how much."""
    before, after = names
    named = listed([change_words(change) for change in changes])
    over = "over whole runs after"
    falls = fit.baseline > _LESS * fit.improved
    course = f"falls from {fit.baseline:.3g} to" if falls else "stays at"
    errors = f"the position error {course} {fit.improved:.3g} mm {over}"
    if verdict == "unchanged":
        return (
            f"Nothing changed between {before} and {after}: the robot as it was before predicts the position after to "
            f"{fit.improved:.3g} mm over whole runs."
        )
    if verdict == "changed":
        return f"The robot changed: {named}. With this, {errors}."
    helps = f" These changes help, but do not suffice: {named}; {errors}." if changes else ""
    return f"Something changed, and no known change of the robot accounts for it.{helps}"


def change_words(change: Change) -> str:
    """A change with its sizes: `right wheel's radius 28 → 27 mm`."""
    if change.of in LIBRARY:
        name, unit = LIBRARY[change.of].name, after_number(change.unit)
        if change.before is None:
            return f"{name}, new after ({change.after:.3g}{unit})"
        return f"{name} ({change.before:.3g} → {change.after:.3g}{unit})"
    motor, dot, key = change.of.rpartition(".")
    came = change.before or 0.0
    if dot:
        side = motor.removesuffix("_motor")
        return f"{side} motor's {_WORDS[key]} {came:.3g} → {change.after:.3g}{after_number(change.unit)}"
    return f"{_WORDS[key]} {1e3 * came:.4g} → {1e3 * change.after:.4g} mm"


def unit_of(of: str) -> str:
    """The unit of a motor's number."""
    return _UNITS[of.rpartition(".")[2]]


def notes(left: RobotLeft | None, after: RobotSide, *, powered: bool) -> tuple[str, ...]:
    """Plain remarks: slip, what is left, what cannot be told."""
    unseen = (
        []
        if powered
        else ["Without the powers on both sides, nothing is said of motors, mass, drag and slope."]
    )
    return (
        *slip_words(after.found.slips),
        *leftover_words(left),
        *untold_words(after.runs),
        *unseen,
    )
