"""Parameters with their doubt: intervals, the anchors they rest on, and ratios where there is no anchor."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.diagnosis import NORMAL_95, Estimate, Moved, Ratio
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.judging.evidence import Evidence
from nxt_twin.diagnose.judging.intervals import FROZEN_DOUBT
from nxt_twin.diagnose.judging.verdict import LIMITS
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.parameter import Parameter
from nxt_twin.physics.signals import VOLTAGES

ANCHORS = ("resistance_ohm", "torque_constant_nm_per_a")
_ANCHORS_OF_CURRENT = ("torque_constant_nm_per_a",)
_KNOWN = 0.5  # of a positive value: the interval is the logarithm's where the standard deviation is less
_SEVERAL = 2  # found effects, from which on one of vague size stands for something else
_VAGUE = 0.75  # of an effect's size: a larger standard deviation leaves the size hardly clear of zero


def estimates(evidence: Evidence, effect: Effect) -> dict[str, Estimate]:
    """The parameters of a found effect, by name, but for those that a search tried in vain, as when a payload went."""
    doubts = _Doubts(evidence)
    plant = evidence.final.plant
    return {
        parameter.name: doubts.estimate(slot, parameter)
        for slot, parameter in plant.layout.parameters.items()
        if slot.owner == effect.id and not parameter.is_idle(plant.values[slot])
    }


def vague_effect(evidence: Evidence) -> Effect | None:
    """The weakest found effect whose size is hardly clear of zero: it stands for something else.

    It is one of several, or brings a simulation of unseen readings no nearer.
    """
    found = [effect for effect, _ in evidence.explanation.found]
    if len(found) < _SEVERAL and evidence.record.nearer < LIMITS.no_nearer:
        return None
    return next((effect for effect in reversed(found) if _is_vague(evidence, effect)), None)


def _is_vague(evidence: Evidence, effect: Effect) -> bool:
    if effect.supersedes:  # what stands for both directions is no size that could be zero
        return False
    found = next(iter(estimates(evidence, effect).values()))  # the main one comes first
    vague = found.std > _VAGUE * abs(found.value - effect.neutral)
    if found.ratio is None:
        return vague
    # What resistance and torque constant leave open is no doubt about the effect, nor what an open inertia does.
    return vague and found.ratio.std > _VAGUE * abs(found.ratio.value)


def has_loose_size(evidence: Evidence) -> bool:
    """Whether the 95 % interval of a found effect's size is wider than the size; its first parameter is its size.

    Not asked of what doubts readings: a few of them leave their share open, and each of them is told.
    """
    found = [effect for effect, _ in evidence.explanation.found if "outlier" not in effect.terms]
    sizes = [next(iter(estimates(evidence, effect).values()), None) for effect in found]
    return any(size is not None and size.is_loose for size in sizes)


def refitted(evidence: Evidence) -> dict[str, Moved]:
    """The baseline's parameters that the re-fit moved, by name."""
    doubts = _Doubts(evidence)
    given, plant = evidence.problem.plant, evidence.final.plant
    moved = {}
    for slot, parameter in plant.layout.parameters.items():
        if slot in given.values and slot in plant.values and slot in doubts.stds:
            found = doubts.estimate(slot, parameter)
            before = given.values[slot] / parameter.si
            moved[parameter.name] = Moved(
                before, found.value, found.std, found.unit, found.interval_95, found.rests_on, found.ratio
            )
    return moved


def surely_moved(refit: Mapping[str, Moved]) -> float:
    """The largest factor by which a positive number of `refit` changed, to the near end of its 95 % interval."""
    factors = [1.0]
    for one in refit.values():
        if one.interval_95 is None or not one.before > 0.0:
            continue
        lower, upper = one.interval_95
        factors += [lower / one.before, one.before / upper if upper > 0.0 else 1.0]
    return max(factors)


def unmoved(refit: Mapping[str, Moved]) -> frozenset[str]:
    """The names of those numbers of `refit` whose 95 % interval holds the given value."""
    known = (
        (name, one.before, one.interval_95) for name, one in refit.items() if one.interval_95 is not None
    )
    return frozenset(name for name, before, (lower, upper) in known if lower <= before <= upper)


@final
class _Doubts:
    """Standard deviations and ratios of one final structure."""

    def __init__(self, evidence: Evidence) -> None:
        self._structure = evidence.final
        self._covariance = evidence.covariance
        self._place = {
            slot: (number, ratio)
            for number, variable in enumerate(evidence.final.fitted.variables)
            for slot, ratio in zip(variable.slots, variable.ratios, strict=True)
        }
        self._is_motor = evidence.problem.plant.layout.frame == "motor"
        self._anchors = ANCHORS if evidence.problem.signals[0].input_kind in VOLTAGES else _ANCHORS_OF_CURRENT
        self.stds = _stds(evidence.final, evidence.covariance)

    def estimate(self, slot: Slot, parameter: Parameter) -> Estimate:
        """The parameter at `slot` with everything that is in doubt about it."""
        value = self._structure.plant.values[slot] / parameter.si
        std = self.stds.get(slot, 0.0) / parameter.si
        rests = self._is_motor and parameter.likeness != 0.0
        return Estimate(
            value=value,
            std=std,
            unit=parameter.unit,
            interval_95=_interval(value, std, positive=parameter.lower >= 0.0) if std > 0.0 else None,
            rests_on=self._anchors if rests else (),
            ratio=self._ratio(slot, parameter) if rests else None,
        )

    def _ratio(self, slot: Slot, parameter: Parameter) -> Ratio | None:
        """A torque over the inertia, a resistance over the winding's: what the recordings fix by themselves."""
        symbol = "resistance" if parameter.is_electrical else "inertia"
        reference = Slot(BASE_OWNER, symbol)
        power = parameter.likeness / self._structure.plant.layout.parameters[reference].likeness
        if slot == reference or slot not in self._place or reference not in self._place:
            return None
        values = self._structure.plant.values
        if values[slot] == 0.0:
            return None
        other = values[reference]
        value = values[slot] / parameter.si * (1.0 / other if power > 0.0 else other)
        (a, a_ratio), (b, b_ratio) = self._place[slot], self._place[reference]
        slope = np.zeros(len(self._covariance))
        slope[a] += a_ratio / values[slot]
        slope[b] -= power * b_ratio / other
        std = abs(value) * math.sqrt(max(float(slope @ self._covariance @ slope), 0.0))
        of = "inertia_kg_m2" if symbol == "inertia" else "resistance_ohm"
        return Ratio(value, std, _ratio_unit(parameter.unit), of)


def _interval(value: float, std: float, *, positive: bool) -> tuple[float, float]:
    """The 95 % interval; of a positive parameter that is known at all, in its logarithm, as its anchors scatter."""
    reach = NORMAL_95 * std
    if positive and std < _KNOWN * value:
        stretch = math.exp(reach / value)
        return value / stretch, value * stretch
    return max(value - reach, 0.0) if positive else value - reach, value + reach


def _ratio_unit(unit: str) -> str:
    known = {"Ω": "1", "H": "s", "A": "V", "N·m": "1/s²", "kg·m²": "1", "N·m·s/rad": "1/s", "N·m/rad": "1/s²"}
    known["1/J"] = "1/(J·Ω)"
    return known.get(unit, f"{unit}/(kg·m²)")


def _stds(structure: Structure, covariance: FloatArray) -> dict[Slot, float]:
    """Standard deviations, SI: from the covariance, and for the share of a fault from counting."""
    readings = max(structure.fitted.readings, 1)
    stds = {}
    for effect in structure.plant.effects:
        if "outlier" in effect.terms:
            parameter = effect.parameters[0]
            slot = Slot(effect.id, parameter.symbol)
            share = structure.plant.values[slot]
            stds[slot] = math.hypot(math.sqrt(share * (1.0 - share) / readings), parameter.law * share)
    spread = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    for variable, std in zip(structure.fitted.variables, spread, strict=True):
        for slot, ratio in zip(variable.slots, variable.ratios, strict=True):
            stds[slot] = float(std) * ratio
            if structure.plant.layout.parameters[slot].frozen and len(variable.slots) > 1:
                stds[slot] = math.hypot(stds[slot], FROZEN_DOUBT * structure.plant.values[slot])
    return stds
