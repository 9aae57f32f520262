"""Which parameters a fit may move, and how far."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Sequence

import numpy as np

from nxt_twin.diagnose.fitting.fit import Variable
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.parameter import Parameter, Scale
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import VOLTAGES, Signals
from nxt_twin.physics.smooth import smoothed

_LOOSE = 0.5  # of what a plant file gives with nothing said of its doubt: a factor of three is rare
_LEAST_SHARE = 0.02  # of a part's ordinary size, where it is there: at none, the fit would lose its variables
_RESISTANCE = Slot(BASE_OWNER, "resistance")


def scale_of(plant: Plant, signals: Sequence[Signals]) -> Scale:
    """The torque, speed and current that are ordinary for this plant in these recordings."""
    moving = np.concatenate([smoothed(s)[1] for s in signals])
    speed = max(float(np.sqrt(np.mean(moving**2))), 1e-6)
    command = np.concatenate([s.command_at_samples() for s in signals])
    push = max(float(np.sqrt(np.mean(command**2))), 1e-6)
    if plant.layout.frame != "motor":
        return Scale(torque=push, speed=speed, recordings=tuple(signals))
    constant = _base(plant, "torque_constant")
    volts = _base(plant, "supply_v")
    match signals[0].input_kind:
        case "current_a":
            return Scale(constant * push, speed, tuple(signals), current=push)
        case "voltage_v":
            volts = push
    current = 0.5 * volts / _base(plant, "resistance")
    return Scale(
        torque=constant * current,
        speed=0.6 * volts / _base(plant, "back_emf"),
        recordings=tuple(signals),
        current=current,
    )


def variables_of(
    plant: Plant, baseline: Plant, scale: Scale, owners: Collection[str] | None = None
) -> tuple[Variable, ...]:
    """The variables that a fit of `plant` moves, or those of them that belong to one of the `owners`.

    Of the baseline: all parameters except its anchors, each with a prior around its given value. Of added
    effects: all parameters except a fault's share, which follows from the readings' weights, and parts that they lack.
    """
    shares = {effect.id for effect in plant.effects if "outlier" in effect.terms}
    driven = scale.recordings[0].input_kind if scale.recordings else None
    alike = plant.layout.frame == "motor" and driven in VOLTAGES
    found = []
    for slot, parameter in plant.layout.parameters.items():
        if slot not in plant.values or slot.owner in shares or parameter.tied_to or parameter.tried:
            continue
        if owners is not None and slot.owner not in owners:
            continue
        if parameter.part_of and plant.values[Slot(slot.owner, parameter.part_of)] == 0.0:
            continue  # a part that is not there
        if slot.owner == BASE_OWNER and plant.values[slot] == 0.0 and not _open(parameter, scale):
            continue  # a servo's loop without that part
        if slot not in baseline.values or not parameter.frozen:
            found.append(
                _variable(
                    slot, parameter.scaled(scale), baseline, alike=alike, known_to=_open(parameter, scale)
                )
            )
    return tuple(found)


def _open(parameter: Parameter, scale: Scale) -> float:
    """How large the recordings leave open that the parameter is, SI, though a plant file says that it is nothing."""
    return parameter.least(scale.recordings) if parameter.least else 0.0


def starts_of(effect: Effect, scale: Scale) -> list[dict[str, float]]:
    """Every combination of starting values of `effect`, SI by symbol; the typical one first."""
    scaled = [parameter.scaled(scale) for parameter in effect.parameters]
    starts = [
        {p.symbol: value * p.si for p, value in zip(scaled, values, strict=True)}
        for values in itertools.product(*(p.starts for p in scaled))
    ]
    further = effect.further_starts(scale.recordings) if effect.further_starts and scale.recordings else ()
    return [*starts, *({**starts[0], **one} for one in further)]


def _variable(slot: Slot, parameter: Parameter, baseline: Plant, *, alike: bool, known_to: float) -> Variable:
    typical = parameter.starts[0] * parameter.si
    given = baseline.values.get(slot)
    centre = typical if given is None else given
    scale = abs(centre) if slot.owner == BASE_OWNER else max(abs(centre), abs(typical)) or 1.0
    doubt = scale * (parameter.spread if given is None else min(parameter.doubt, _LOOSE))
    if slot.owner == BASE_OWNER and centre == 0.0:
        scale = doubt = known_to
    tied = list(baseline.layout.tied.get(slot, ()))
    if alike and slot == _RESISTANCE:
        tied += _given_with_it(baseline, parameter.likeness)
    part = parameter.part_of == parameter.symbol
    least = _LEAST_SHARE * (abs(typical) or 1.0) if part else min(parameter.lower * parameter.si, centre)
    return Variable(
        slots=(slot, *tied),
        ratios=(1.0, *(baseline.values[other] / centre for other in tied)),
        scale=scale,
        lower=least,
        upper=max(parameter.upper * parameter.si, centre),
        centre=centre,
        spread=doubt,
        likeness=parameter.likeness if alike else 0.0,
        shared_out=parameter.shared_out,
    )


def _given_with_it(baseline: Plant, likeness: float) -> list[Slot]:
    """What no fit moves by itself and is known, if at all, as a ratio to the resistance: a winding's inductance."""
    return [
        slot
        for slot, parameter in baseline.layout.parameters.items()
        if slot in baseline.values and parameter.frozen and parameter.likeness == likeness
    ]


def _base(plant: Plant, symbol: str) -> float:
    return plant.values[Slot(BASE_OWNER, symbol)]
