"""Whether an effect in a plant is large enough to have a name."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from nxt_twin.diagnose.search.coincidence import HIDDEN_BY
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.effects.load import NEVER_S
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.parameter import ANGLE, STIFFNESS, Parameter, Scale
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals

_CLEAR = 1.3  # times a parameter's lower bound: a value below it rests on the bound
_ABOVE = 1.1  # times the size at which an effect does nothing: a smaller one makes no difference
_HARDLY = 0.5  # of its notable size, from which an effect may have a name
_PERIODS = 2.0  # periods of an effect by angle that one recording has to go through
_LEAST_SHARE = 0.14  # of the inertia of both bodies
_SLOWEST_PACE = 0.006
"""By how much a clock of rows and commands has to run faster or slower at its quickest, to have a name.

A supply or a torque constant that changes by less makes an equal motion, and laws of other names leave as much.
"""
_CLEAR_OF_JITTER = 3.0
"""Standard deviations of the time between readings that a reading has to be held for.

A clean mock over Bluetooth, polled every 48 ms with 7 ms of jitter, was said to hold readings for 10 ms.
"""
LEAST_LEVER_M = 0.005
"""Lever below which a payload that hangs on the axis is none: a motor's own hub is as thick.

A payload m on a lever l brings τg = m·g·l and J = m·l², so that l = J·g/τg. On the sets 700 and 721 an arm without any
added inertia was named a payload on levers of 1.5 and 1.9 mm.
"""
LONGEST_LEVER_M = 2.0
"""Lever above which a payload hangs on no arm: it is a disc, whatever torque is found beside it.

A wheel of radius of gyration k, off its centre by r, has J·g/τg = r + k²/r: 2 m with k of 45 mm and r of 1 mm.
"""
_HUNG_ON_S = 0.5  # nobody hangs a payload on in less: it was there from the first reading on
_G = 9.81  # m/s²: standard gravity
_USUALLY_WOUND_RAD = 10.0  # that a spring of notable stiffness is wound: what counts is its torque
_BOTH_WAYS = 2  # parameters of an effect that replaces a plain term by one forward and one in reverse
_LEAST_APART = 0.05  # of their sum, or a load's size of friction: less is the plain term, as motors have it


def is_notable(plant: Plant, effect: Effect, scale: Scale) -> bool:
    """Whether `effect` is clear of what makes no difference, and of what motors of one make differ by."""
    main = effect.parameters[0]
    value = plant.values[Slot(effect.id, main.symbol)]
    lower = _carried(main, main.lower, plant, scale)
    nothing = _nothing(plant, effect, scale)
    makes_a_difference = value > _CLEAR * lower and (nothing <= 0.0 or value > _ABOVE * nothing)
    least, most = (_carried(main, each, plant, scale) for each in (effect.notable, effect.notable_most))
    sized = makes_a_difference and least <= _size(plant, effect, scale) <= most
    return sized and not _stands_for_another(plant, effect, scale)


def is_too_small(plant: Plant, effect: Effect, scale: Scale) -> bool:
    """Whether all that `effect` lacks for a name is size.

    A fault that doubts or scatters readings is none: it would take in what any other effect leaves.
    """
    main = effect.parameters[0]
    if "outlier" in effect.terms or effect.holds_readings or _stands_for_another(plant, effect, scale):
        return False
    value = plant.values[Slot(effect.id, main.symbol)]
    lower = _carried(main, main.lower, plant, scale)
    size = _size(plant, effect, scale)
    return size < _carried(main, effect.notable, plant, scale) or 0.0 < value <= _CLEAR * lower


def is_hardly_too_small(plant: Plant, effect: Effect, scale: Scale) -> bool:
    """Whether `effect` has half of the size that a name takes."""
    size = _size(plant, effect, scale)
    return size > _HARDLY * _carried(effect.parameters[0], effect.notable, plant, scale)


def _nothing(plant: Plant, effect: Effect, scale: Scale) -> float:
    """The size of the main parameter at which the effect does nothing, SI."""
    main = effect.parameters[0]
    least = main.least(scale.recordings) if main.least else 0.0
    return max(plant.values.get(Slot(*main.above), 0.0) if main.above else 0.0, least)


def _stands_for_another(plant: Plant, effect: Effect, scale: Scale) -> bool:
    """Whether its other parameters say that it is no such effect."""
    on_a_bound = any(_on_a_bound(plant, effect, parameter, scale) for parameter in effect.parameters[1:])
    return (
        on_a_bound or _is_light(plant, effect) or _is_an_arm(plant, effect) or _is_a_slow_clock(plant, effect)
    )


def is_repeated(plant: Plant, effect: Effect, recordings: Sequence[Signals]) -> bool:
    """Whether a recording goes through two periods of an effect that repeats with the angle.

    Within less, what is called periodic may be any function of the angle, such as the torque of an arm.
    """
    turns = max((float(np.ptp(one.measured[np.isfinite(one.measured)])) for one in recordings), default=0.0)
    turns /= 2.0 * math.pi
    cycles = [
        plant.values[Slot(effect.id, p.symbol)] for p in effect.parameters if p.name.endswith("per_turn")
    ]
    return all(turns * each >= _PERIODS for each in cycles)


def is_told_from_jitter(plant: Plant, effect: Effect, recordings: Sequence[Signals]) -> bool:
    """Whether in some recording readings that `effect` holds are older than the jitter of its polls could make them.

    They are held for longer than they are apart, too: below that no reading repeats, and a stamp's jitter looks alike.
    """
    if not effect.holds_readings:
        return True
    held_s = plant.values[Slot(effect.id, effect.parameters[0].symbol)]
    return any(held_s > max(_CLEAR_OF_JITTER * _jitter_s(one), one.interval_s) for one in recordings)


def _jitter_s(signals: Signals) -> float:
    """The standard deviation of the time from one reading to the next, robust, s."""
    between_s = np.diff(signals.time_s[np.isfinite(signals.measured)])
    return 1.4826 * float(np.median(np.abs(between_s - np.median(between_s))))


def _is_light(plant: Plant, effect: Effect) -> bool:
    """Whether a second body is too light to be one: friction that yields a little is taken for such."""
    load = plant.values.get(Slot(effect.id, "load_inertia"))
    return load is not None and load < _LEAST_SHARE * (load + plant.values[Slot(BASE_OWNER, "inertia")])


def _is_a_slow_clock(plant: Plant, effect: Effect) -> bool:
    """Whether stamps of rows and commands wander together, and so slowly that a speed which changes looks alike."""
    own = {slot.symbol: value for slot, value in plant.values.items() if slot.owner == effect.id}
    if own.get("waves", 0.0) == 0.0 or own["of_commands"] == 0.0:
        return False
    straight = own["lag_straightness"]
    steepest = (straight + (1.0 - straight) * 0.5 * math.pi) / min(own["lag_rise"], 1.0 - own["lag_rise"])
    return own["lag_span"] * steepest / own["lag_period"] < _SLOWEST_PACE


def _is_an_arm(plant: Plant, effect: Effect) -> bool:
    """Whether a payload that hangs adds hardly an inertia, or hardly a torque, or did from the first reading on.

    It is an arm then, with or without a heavier motor, or a disc, which have names of their own.
    """
    own = {slot.symbol: value for slot, value in plant.values.items() if slot.owner == effect.id}
    if "payload_gravity" not in own:
        return False
    moment = own["payload_inertia"] * _G
    a_lever = LEAST_LEVER_M * own["payload_gravity"] <= moment <= LONGEST_LEVER_M * own["payload_gravity"]
    return not a_lever or (own["hung_at"] < _HUNG_ON_S and own["taken_off_at"] >= NEVER_S)


def _on_a_bound(plant: Plant, effect: Effect, parameter: Parameter, scale: Scale) -> bool:
    """Whether a time constant came to rest at its least value: what it stands for is then no such course of time."""
    value = plant.values[Slot(effect.id, parameter.symbol)]
    lower = _carried(parameter, parameter.lower, plant, scale)
    return parameter.name.endswith("time_constant_s") and value < _CLEAR * lower


def _size(plant: Plant, effect: Effect, scale: Scale) -> float:
    """What of the main parameter is the effect's own, SI; of a spring that is wound far, what one wound less has."""
    value = plant.values[Slot(effect.id, effect.parameters[0].symbol)]
    if effect.supersedes and len(effect.parameters) == _BOTH_WAYS:
        other = plant.values[Slot(effect.id, effect.parameters[1].symbol)]
        apart = abs(value - other)
        return 0.5 * apart if apart > _LEAST_APART * (value + other) else 0.0
    size = abs(value - effect.neutral * effect.parameters[0].si) - _nothing(plant, effect, scale)
    friction = plant.values.get(HIDDEN_BY[effect.id], 0.0) if effect.id in HIDDEN_BY else 0.0
    return _wound(plant, effect, scale) * size if size > _LEAST_APART * friction else 0.0


def _wound(plant: Plant, effect: Effect, scale: Scale) -> float:
    """How many times as far as is usual a spring is wound; 1 for less, for others, and for a spring along a line."""
    main, *others = effect.parameters
    rests = [one.symbol for one in others if one.dimension == ANGLE]
    if main.dimension != STIFFNESS or plant.layout.frame == "linear" or not rests:
        return 1.0
    rest = plant.values[Slot(effect.id, rests[0])]
    angles = [one.measured for one in scale.recordings if not one.is_speed]
    furthest = max((float(np.nanmax(np.abs(each - rest), initial=0.0)) for each in angles), default=0.0)
    return max(furthest / _USUALLY_WOUND_RAD, 1.0)


def _carried(parameter: Parameter, value: float, plant: Plant, scale: Scale) -> float:
    """A value of the parameter, given in its unit at NXT scale, for this plant, SI."""
    own = replace(parameter, lower=value, hints=None).in_frame(plant.layout.frame).scaled(scale)
    return own.lower * own.si
