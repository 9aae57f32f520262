"""The sentences of a comparison."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from nxt_twin.diagnose.changed.answer import Change, ChangeVerdict, OtherChange
from nxt_twin.diagnose.changed.engine import Compared
from nxt_twin.diagnose.diagnosis import Fit
from nxt_twin.diagnose.telling.words import listed
from nxt_twin.diagnose.units import after_number
from nxt_twin.physics.library import library

_UNIT_SUFFIX = re.compile(
    r"_(pct_s_per_deg|pct_per_deg|deg_per_s|v_per_s|per_s|kg_m2|kg|nm_per_a|nm_s_per_rad|nm_per_rad|n_s_per_m|v_s_per_rad"
    r"|nm|n|ohm|h|v|a|s|deg|pct|m|rad_s)$"
)
_LOOP = "servo's loop"
_PART_OF = {
    "load": {
        "gravity_torque_nm",
        "phase_deg",
        "inertia_kg_m2",
        "inertia",
        "gravity_load",
        "constant_load",
        "spring_load",
        "load_torque_nm",
        "load_force_n",
        "load_inertia_kg_m2",
    },
    "motor": {
        "resistance_ohm",
        "torque_constant_nm_per_a",
        "winding_heating",
        "voltage_drop",
        "current_limit",
    },
    _LOOP: {
        "position_gain_pct_per_deg",
        "derivative_gain_pct_s_per_deg",
        "goal_rate_limit",
        "goal_rate_limit_deg_per_s",
        "integral_action",
        "integral_rate_per_s",
        "loop_dead_band",
        "width_deg",
        "power_limit",
        "limit_pct",
    },
    "supply": {"supply_v", "battery_sag", "battery_drain", "internal_resistance_ohm", "drain_v_per_s"},
}
_OTHER_SUPPLY = 0.03  # of the supply before
_NEARER = 0.8  # of an error: what a reader would call better
_CLEARLY_MORE = 2.0  # times the error before: what a reader would not call one model's
_FRICTION = re.compile(r"friction|stiction|coulomb|viscous|drag|presliding")


def sentence(verdict: ChangeVerdict, changes: Sequence[Change], fit: Fit, compared: Compared) -> str:
    """What changed, and by how much."""
    before, after = compared.before.name, compared.after.name
    named = listed([change_words(change) for change in changes])
    errors = f"{fit.baseline:.3g} {fit.unit} off, now {fit.improved:.3g}"
    if verdict == "unchanged":
        return unchanged_words(before, after, fit, _error_before(compared, fit))
    if verdict == "unexplained":
        helps = f" These changes help, but do not suffice: {named} (error {errors})." if changes else ""
        return (
            f"Something changed, and no few parameters or effects account for it.{helps} {_reach(after, fit)}"
        )
    parts = _parts(changes)
    return f"The {listed(parts)} changed: {named}. {_unchanged(parts)}Error of simulated windows after: {errors}."


def unchanged_words(before: str, after: str, fit: Fit, error_before: float | None) -> str:
    """That no change is told; `error_before` is in the unit of `fit`, None where the error after does not matter."""
    error = f"{fit.improved:.3g} {fit.unit}"
    if error_before is not None and error_before * _CLEARLY_MORE < fit.improved:
        return (
            f"No change is shown between {before} and {after}, yet one model of both errs more after: "
            f"{error}, and {error_before:.3g} {fit.unit} before."
        )
    return (
        f"Nothing changed between {before} and {after}: one model predicts held-out windows of both. "
        f"Its error after is {error}."
    )


def _error_before(compared: Compared, fit: Fit) -> float | None:
    """The error of the one model before, in the unit of `fit`; None where that after does not matter."""
    before, after = compared.chosen.joint.check_rms
    return before / after * fit.improved if after > compared.tolerance else None


def _reach(after: str, fit: Fit) -> str:
    """The error that a separate plant of the side after reaches."""
    if fit.floor < _NEARER * fit.improved:
        return f"A separate model of {after} errs by {fit.floor:.3g} {fit.unit}."
    return f"No other parameters of this model bring its error in {after} below {fit.floor:.3g} {fit.unit}."


def others_notes(others: Sequence[OtherChange]) -> list[str]:
    """Of each named change, those that the recordings do not tell from it."""
    names = {effect.id: effect.name for effect in library().values()}
    found = []
    for name in dict.fromkeys(other.instead_of for other in others):
        own = [other for other in others if other.instead_of == name]
        rivals = listed([names.get(other.id) or parameter_words(other.id) for other in own])
        verb = "fits" if len(own) == 1 else "fit"
        found.append(
            f"{rivals} instead of {names.get(name) or parameter_words(name)} {verb} these recordings as well"
        )
    return found


def notes(compared: Compared, fit: Fit) -> tuple[str, ...]:
    """How the limit was found, and what both sides lack."""
    source = (
        "repeats of one side set this limit"
        if compared.calibrated
        else "no side has repeats that could set it"
    )
    found = [f"a change counts if it gains {compared.limit_nats:.2g} nats beyond its penalty ({source})"]
    names = {effect.id: effect.name for effect in library().values()}
    common = compared.chosen.lacking
    if common:
        what = listed([names[each] for each in common])
        found.append(f"the model leaves out {what} on both sides, so this is no change")
    found += _supply_note(compared)
    if not 0.0 < fit.improved < 1e6:
        found.append("the simulated windows diverge; check units and signs of the recordings")
    return tuple(found)


def _supply_note(compared: Compared) -> list[str]:
    """A remark where the supply was read and is another after: the model has it as an input."""
    before_v, after_v = (
        float(np.median(np.concatenate([one.command_supply_v for one in problem.signals])))
        for problem in (compared.before, compared.after)
    )
    if not abs(after_v - before_v) > _OTHER_SUPPLY * before_v:
        return []
    return [
        f"the supply was {before_v:.2f} V before and {after_v:.2f} V after; the model takes it as an input"
    ]


def parameter_words(name: str) -> str:
    """A parameter's name without its unit: `gravity_torque_nm` is the gravity torque."""
    return _UNIT_SUFFIX.sub("", name).replace("_", " ")


def change_words(change: Change) -> str:
    """A change with its sizes: `inertia 0.001 → 0.002 kg·m²`."""
    unit = after_number(change.unit)
    if change.before is None:
        name = {effect.id: effect.name for effect in library().values()}[change.of]
        main = parameter_words(next(iter(change.params)))
        return f"{name} is new ({main} {change.after:.3g}{unit})"
    return f"{parameter_words(change.of)} {change.before:.3g} → {change.after:.3g}{unit}"


def _parts(changes: Sequence[Change]) -> list[str]:
    return sorted({_part(change.of) for change in changes})


def _unchanged(parts: Sequence[str]) -> str:
    if "motor" in parts:
        return ""
    beside = set(parts) <= {"recording", _LOOP}
    return f"The motor{' and its load' if beside else ''} did not change. "


def _part(of: str) -> str:
    for part, names in _PART_OF.items():
        if of in names:
            return part
    if _FRICTION.search(of):
        return "friction"
    effect = library().get(of)
    if effect and effect.equation_of in ("measurement", "timing"):
        return "recording"
    return "transmission" if effect and effect.equation_of == "kinematic" else "load"
