"""From a comparison to what it says of each parameter and effect."""

from __future__ import annotations

import math

from nxt_twin.diagnose.changed import words
from nxt_twin.diagnose.changed.answer import Change, Changes, ChangeVerdict, OtherChange
from nxt_twin.diagnose.changed.engine import Compared
from nxt_twin.diagnose.changed.held_out import runs_of
from nxt_twin.diagnose.changed.model import Model
from nxt_twin.diagnose.diagnosis import Estimate, Fit, FoundEffect, Mismatch, Moved, Tolerance
from nxt_twin.diagnose.units import Units, units_of
from nxt_twin.physics.effect import Equation
from nxt_twin.physics.layout import BASE_OWNER
from nxt_twin.physics.parameter import Parameter

_Z = 1.96  # standard deviations from a value to either end of its 95 % interval
_SURE_NATS = 50.0  # more is as good as sure, and no exponential overflows
_FURTHER_OFF = 1.5  # than a plant of its own: what few changes do not account for
_MUCH_FURTHER_OFF = 6.0  # than the side before: what no parameter accounts for
_MANY = 0.2  # of all windows: one in which the motor sticks otherwise is no change


def told(compared: Compared) -> Changes:
    """The answer for one side after."""
    changes = _changes(compared)
    verdict = _verdict(compared)
    fit = _fit(compared)
    units = _units(compared)
    joint = compared.chosen.joint
    others = _others(compared)
    return Changes(
        name=compared.after.name,
        before=compared.before.name,
        verdict=verdict,
        sentence=words.sentence(verdict, changes, fit, compared),
        changes=changes,
        refit=_refit(compared),
        effects=_effects(compared, changes),
        fit=fit,
        tolerance=Tolerance(compared.tolerance * units.reading_factor, fit.unit, fit.improved),
        mismatch=Mismatch(compared.after.signals[0].channel, (), (), _equation(compared)),
        notes=(*words.others_notes(others), *words.notes(compared, fit)),
        held_out=runs_of(compared.predicted, units),
        plant=joint.model.plant_as_told(joint.x, after=True),
        alternatives=others,
    )


def _units(compared: Compared) -> Units:
    return units_of(compared.before.plant.layout.frame, compared.before.signals[0])


def _verdict(compared: Compared) -> ChangeVerdict:
    """By windows that were not fitted: against a plant of the side's own, and against the side before."""
    own, found = compared.free.check_rms, compared.drifted.check_rms
    tolerance = compared.tolerance
    fits_better = compared.free.check_cost < compared.drifted.check_cost
    gains = fits_better and compared.net_of_free > compared.limit_nats
    if gains and found[1] > _FURTHER_OFF * own[1] and found[1] > own[1] + tolerance:
        return "unexplained"
    limit = max(_MUCH_FURTHER_OFF * found[0], found[0] + 2.0 * tolerance)
    if found[1] > limit and compared.predicted.share_beyond(limit) > _MANY:
        return "unexplained"
    return "changed" if compared.chosen.joint.model.changes else "unchanged"


def _fit(compared: Compared) -> Fit:
    units = _units(compared)
    factor = units.reading_factor
    return Fit(
        metric=f"windows of {compared.window_s:.2g} s after that were not fitted, RMS",
        unit=units.reading,
        baseline=compared.predicted.rms_before * factor,
        improved=compared.chosen.joint.check_rms[1] * factor,
        floor=min(compared.free.check_rms[1], compared.chosen.joint.check_rms[1]) * factor,
    )


def _others(compared: Compared) -> tuple[OtherChange, ...]:
    """Changes that the readings do not tell from named ones."""
    factor = _units(compared).reading_factor
    model = compared.chosen.joint.model
    return tuple(
        OtherChange(
            _name(rival.joint.model, rival.of),
            _name(model, rival.instead_of),
            1.0 / (1.0 + math.exp(min(-rival.worth, _SURE_NATS))),
            rival.joint.check_rms[1] * factor,
        )
        for rival in compared.chosen.rivals
    )


def _name(model: Model, each: int | str) -> str:
    """The parameter's name, or the effect's id."""
    return each if isinstance(each, str) else model.plant.layout.parameters[model.ways[each].slot].name


def _changes(compared: Compared) -> tuple[Change, ...]:
    model = compared.chosen.joint.model
    found = [_of_parameter(compared, n) for n in model.differs]
    found += [_of_effect(compared, each) for each in model.effects]
    return tuple(sorted(found, key=lambda change: -change.probability))


def _of_parameter(compared: Compared, index: int) -> Change:
    joint = compared.chosen.joint
    slot = joint.model.ways[index].slot
    parameter = joint.model.plant.layout.parameters[slot]
    place = joint.model.names().index(("differs", slot))
    before, after = (
        joint.model.plant_as_told(joint.x, after=side).values[slot] / parameter.si for side in (False, True)
    )
    positive = index >= len(joint.model.shared) or joint.model.shared[index].positive
    estimate = _estimate(compared, place, after, parameter, positive=positive)
    return Change(
        parameter.name,
        before,
        after,
        estimate.std,
        parameter.unit,
        estimate.interval_95 or (after, after),
        _probability(compared, index),
    )


def _of_effect(compared: Compared, effect_id: str) -> Change:
    joint = compared.chosen.joint
    layout = joint.model.plant.layout
    plant = joint.model.plant_at(joint.x, after=True)
    params = {}
    for variable in joint.model.added:
        slot = variable.slots[0]
        if slot.owner == effect_id:
            parameter = layout.parameters[slot]
            place = joint.model.names().index(("added", slot))
            value = plant.values[slot] / parameter.si
            params[parameter.name] = _estimate(compared, place, value, parameter, positive=variable.positive)
    main = next(iter(params.values()))
    interval = main.interval_95 or (main.value, main.value)
    return Change(
        effect_id, None, main.value, main.std, main.unit, interval, _probability(compared, effect_id), params
    )


def _estimate(
    compared: Compared, place: int, value: float, parameter: Parameter, *, positive: bool
) -> Estimate:
    std = math.sqrt(max(float(compared.covariance[place, place]), 0.0))
    if positive:
        reach = math.exp(min(_Z * std, 50.0))
        return Estimate(value, value * std, parameter.unit, (value / reach, value * reach))
    std /= parameter.si
    return Estimate(value, std, parameter.unit, (value - _Z * std, value + _Z * std))


def _probability(compared: Compared, each: int | str) -> float:
    return 1.0 / (1.0 + math.exp(-min(compared.chosen.nats[each], _SURE_NATS)))


def _refit(compared: Compared) -> dict[str, Moved]:
    joint = compared.chosen.joint
    given = compared.before.plant.values
    now = joint.model.plant_at(joint.x, after=False).values
    found = {}
    for place, variable in enumerate(joint.model.shared):
        for slot in variable.slots:
            if slot not in given:
                continue
            parameter = joint.model.plant.layout.parameters[slot]
            value = now[slot] / parameter.si
            own = _estimate(compared, place, value, parameter, positive=variable.positive)
            name = parameter.name if _is_plain(compared, slot.owner) else f"{slot.owner}.{parameter.name}"
            found[name] = Moved(given[slot] / parameter.si, value, own.std, parameter.unit, own.interval_95)
    return found


def _is_plain(compared: Compared, owner: str) -> bool:
    return owner == BASE_OWNER or compared.before.plant.layout.effect(owner).plain


def _effects(compared: Compared, changes: tuple[Change, ...]) -> tuple[FoundEffect, ...]:
    layout = compared.before.plant.layout
    known = {effect.id: effect for effect in layout.effects}
    return tuple(
        FoundEffect(
            change.of,
            known[change.of].name,
            known[change.of].equation,
            change.params,
            change.probability,
            (),
        )
        for change in changes
        if change.params
    )


def _equation(compared: Compared) -> Equation | None:
    """Of the change that is worth most."""
    nats = compared.chosen.nats
    if not nats:
        return None
    most = max(nats, key=lambda each: nats[each])
    model = compared.chosen.joint.model
    if isinstance(most, str):
        return model.plant.layout.effect(most).equation_of
    slot = model.ways[most].slot
    if slot.owner != BASE_OWNER:
        return model.plant.layout.effect(slot.owner).equation_of
    mechanical = slot.symbol == "inertia" or model.plant.layout.frame != "motor"
    return "torque_balance" if mechanical else "electrical"
