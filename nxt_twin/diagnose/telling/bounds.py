"""Parameters that a fit moved to a bound, which the answer has to tell."""

from __future__ import annotations

from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.physics.plant import Plant


def at_bounds(problem: Problem, plant: Plant) -> tuple[str, ...]:
    """A sentence on each number of `plant` that a fit moved to nothing, or as far as it may."""
    said = []
    for slot, parameter in plant.layout.parameters.items():
        if slot not in plant.values or parameter.frozen or parameter.tied_to or not parameter.is_bounded:
            continue
        if problem.plant.values.get(slot) == 0.0 == plant.values[slot]:  # a loop without that part
            continue
        scaled = parameter.scaled(problem.scale)
        value = plant.values[slot] / parameter.si
        if value <= scaled.lower and scaled.lower == 0.0:
            said.append(f"The fit moved {parameter.name} to 0: these recordings do not show it.")
        elif value >= scaled.upper:
            said.append(
                f"The fit moved {parameter.name} to its upper bound, {scaled.upper:.3g} {parameter.unit}."
            )
    return tuple(said)
