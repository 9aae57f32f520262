"""From a robot's powers to what its body and its floor add."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np
from scipy.special import stdtrit

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.diagnosis import Confusion, Estimate, FoundEffect, Moved
from nxt_twin.diagnose.robot.choice import WeighedSubsets, asked_of, beyond, weigh
from nxt_twin.diagnose.robot.effects import POWERED, RobotEffect
from nxt_twin.diagnose.robot.fit import robust_nats
from nxt_twin.diagnose.robot.leftover import RobotLeft
from nxt_twin.diagnose.robot.moved_motors import moved_motors, moved_words
from nxt_twin.diagnose.robot.powered_fit import PoweredFit, cost_of, fit_powered, noise_deg, rms_of
from nxt_twin.diagnose.robot.powered_runs import PoweredStack, powered_stack
from nxt_twin.diagnose.robot.slip import SlipSpell
from nxt_twin.diagnose.robot.words import why_confusable
from nxt_twin.physics.robot.drive import DifferentialDrive, Geometry
from nxt_twin.physics.robot.dynamics import LOAD_GYRATION, NAMES
from nxt_twin.physics.robot.powered import powered_robot
from nxt_twin.recording.recording import Recording

PLACES: Final = {
    "caster_drag": [12],
    "floor_slope": [13, 14],
    "centre_of_mass_offset": [15, 16],
    "payload_mass": [17],
    "battery_sag": [19],
    "left_motor.asymmetric_friction": [20],
    "right_motor.asymmetric_friction": [21],
    "left_motor.quadratic_drag": [22],
    "right_motor.quadratic_drag": [23],
    "left_motor.voltage_drop": [24],
    "right_motor.voltage_drop": [25],
}
MATTERS: Final = {
    "caster_drag": 0.05,
    "floor_slope": 5e-3,
    "centre_of_mass_offset": 3e-3,
    "payload_mass": 0.05,
    "battery_sag": 0.2,
    **dict.fromkeys(("left_motor.asymmetric_friction", "right_motor.asymmetric_friction"), 2e-3),
    **dict.fromkeys(("left_motor.quadratic_drag", "right_motor.quadratic_drag"), 3e-4),
    **dict.fromkeys(("left_motor.voltage_drop", "right_motor.voltage_drop"), 0.25),
}
"""Smaller sizes are not named: N, rise, m, kg, ohm, N·m, N·m·s²/rad², V."""

_EITHER_WAY: Final = (
    "floor_slope",
    "centre_of_mass_offset",
    "left_motor.asymmetric_friction",
    "right_motor.asymmetric_friction",
)
_OF_BODY: Final = ("caster_drag", "floor_slope", "centre_of_mass_offset", "payload_mass", "battery_sag")
_NEAR_NATS: Final = 10.0
"""Rivals that are behind by less are fitted by themselves."""
_MOST_RIVALS: Final = 2  # that are fitted by themselves, the nearest first
_SURELY_SIGMAS: Final = 1.5
"""An effect matters if it does so after its size is taken down by so many standard deviations."""
_SURER: Final = 0.5
"""Of what the refits chose, the least probability."""
_LATE_S: Final = (0.02, 0.04, 0.06, 0.09, 0.12)
_CLOSER_S: Final = 0.01  # to either side of the best of these delays, where two more are tried
_CLEARLY: Final = 0.7  # share of the residuals' size below which a delay has to bring it to be kept
STRUCTURED_TIMES: Final = 2.5
"""What three seconds leave is more than noise where it is so many times what half a second leaves."""


@final
@dataclass(frozen=True)
class PoweredFindings:
    """The findings from the motor powers.

    Attributes:
        effects: named, with parameters.
        values: motors, body and effects, in the order of `dynamics.NAMES`.
        left: what is left, None where it is noise.
        notes: plain remarks.
        moved: numbers of the motors that the fit moved clearly, by the plant's keys.
    """

    effects: tuple[FoundEffect, ...]
    values: FloatArray
    left: RobotLeft | None
    notes: tuple[str, ...]
    moved: dict[str, Moved]


def search_powered(
    recordings: Sequence[Recording],
    held: Sequence[Recording],
    drive: DifferentialDrive,
    geometry: Geometry,
    slips: Sequence[SlipSpell] = (),
) -> PoweredFindings:
    """Fit motors and body to the wheels' angles, and name what the body and the floor add.

    Args:
        recordings: to fit, with both powers.
        held: not to fit; judged where they hold powers too.
        drive: the robot as its model came.
        geometry: the wheels and the track as they were fitted.
        slips: spells of slip in `recordings`.

    Raises:
        PlantError: a dynamic key is missing or none.
    """
    robot = powered_robot(drive)
    full, stack = fit_body(recordings, drive, geometry, slips)
    able = {name: places for name, places in PLACES.items() if _matters(name, full.off[places])}
    weighed = weigh(able, beyond(full.off, sizes_that_matter()), full.covariance, full.clusters)
    named, final = _refitted(weighed, full, stack, robot.values)
    values, covariance = final.values, final.covariance
    effects = tuple(
        replace(
            found_powered(effect, values, with_unknown_load(covariance, values, geometry), full.clusters),
            probability=_surer(weighed.probability[effect.key]),
            confusable_with=tuple(
                Confusion(one, why_confusable(effect.key, one)) for one in weighed.rivals.get(effect.key, ())
            ),
        )
        for effect in POWERED
        if effect.key in named
    )
    ratio = full.left_deg / noise_deg(stack, full.values)
    left = (
        RobotLeft("the powers", "wheels", ratio, 1.0 - 1.0 / ratio**2) if ratio > STRUCTURED_TIMES else None
    )
    moved = moved_motors(robot.values, final)
    notes = (*moved_words(moved), *_notes(held, drive, geometry, values, stack.delay_s))
    return PoweredFindings(effects, values, left, notes, moved)


def _refitted(
    weighed: WeighedSubsets, full: PoweredFit, stack: PoweredStack, given: FloatArray
) -> tuple[frozenset[str], PoweredFit]:
    """The effects that cost least once they alone are fitted, of the best subset and its nearest rivals.

    The weighing takes the fit of everything for quadratic, which it is not far from where it ends.
    """
    fits: dict[frozenset[str], PoweredFit] = {}
    found = []
    for ids in _to_refit(weighed):
        kept, fitted = _that_matter(ids, full, stack, given, fits)
        asked = sum(asked_of(len(PLACES[one])) for one in kept)
        found.append((cost_of(stack, fitted, full.ruler) + asked, kept, fitted))
    _, named, final = min(found, key=lambda one: one[0])
    return named, final


def _to_refit(weighed: WeighedSubsets) -> list[frozenset[str]]:
    """The best subset, those with one effect less, and the nearest rivals."""
    near = [ids for ids, behind in weighed.second if behind < _NEAR_NATS]
    fewer = [weighed.best - {one} for one in sorted(weighed.best)] if len(weighed.best) > 1 else []
    return [weighed.best, *fewer, *near[:_MOST_RIVALS]]


def _surer(probability: float) -> float:
    """The probability of an effect of the subset that was chosen by refits, whatever the weighing said."""
    return max(probability, _SURER)


def _that_matter(
    ids: frozenset[str],
    full: PoweredFit,
    stack: PoweredStack,
    given: FloatArray,
    fits: dict[frozenset[str], PoweredFit],
) -> tuple[frozenset[str], PoweredFit]:
    """A fit of these effects alone, without those that may then be too small to matter.

    `fits` holds earlier ones. The nearest of them is where a fit begins.
    """
    while True:
        if ids not in fits:
            free = _with(ids)
            fits[ids] = fit_powered(stack, given, free, np.where(free, full.off, 0.0))
        fitted = fits[ids]
        std = np.sqrt(np.diag(fitted.covariance))
        surely = np.maximum(np.abs(fitted.off) - _SURELY_SIGMAS * std, 0.0) * np.sign(fitted.off)
        small = {one for one in ids if not _matters(one, surely[PLACES[one]]) or _evidence(one, fitted) < 0.0}
        if not small:
            return ids, fitted
        ids -= small


def _evidence(name: str, fitted: PoweredFit) -> float:
    """What an effect gains in a fit beyond what it has to, nats, by how its evidence spreads over windows and runs."""
    places = PLACES[name]
    off = beyond(fitted.off, sizes_that_matter())[places]
    squared = float(off @ np.linalg.solve(fitted.covariance[np.ix_(places, places)], off))
    return robust_nats(squared, fitted.clusters) - asked_of(len(places))


def fit_body(
    recordings: Sequence[Recording],
    drive: DifferentialDrive,
    geometry: Geometry,
    slips: Sequence[SlipSpell] = (),
) -> tuple[PoweredFit, PoweredStack]:
    """Fit motors, body and all that body and floor may add to the wheels' angles.

    Where this leaves more than noise, commands may act later than their stamps. A delay is kept if errors then fall
    by three tenths.

    Raises:
        PlantError: a dynamic key is missing or none.
    """
    robot = powered_robot(drive)
    stack = powered_stack(recordings, drive, geometry, robot, slips)
    free = np.ones(len(NAMES), dtype=bool)
    begun = fit_powered(stack, robot.values, _with(_OF_BODY))
    fitted = fit_powered(stack, robot.values, free, begun.off)
    if fitted.left_deg < STRUCTURED_TIMES * noise_deg(stack, fitted.values):
        return fitted, stack
    later = [fit for late_s in _LATE_S for fit in _fit_later(stack, late_s, robot.values)]
    coarse_s = min(later, key=_left_deg, default=(fitted, stack))[1].delay_s
    for late_s in (coarse_s - _CLOSER_S, coarse_s + _CLOSER_S):
        later += _fit_later(stack, late_s, robot.values)
    found = min(later, key=_left_deg, default=(fitted, stack))
    return found if found[0].left_deg < _CLEARLY * fitted.left_deg else (fitted, stack)


def _left_deg(each: tuple[PoweredFit, PoweredStack]) -> float:
    return each[0].left_deg


def _fit_later(
    stack: PoweredStack, late_s: float, given: FloatArray
) -> list[tuple[PoweredFit, PoweredStack]]:
    """The fit where commands act later than their stamps; none where it leads to no numbers."""
    later = stack.delayed(late_s)
    with np.errstate(all="ignore"):
        try:
            fit = fit_powered(later, given, np.ones(len(NAMES), dtype=bool))
        except np.linalg.LinAlgError:
            return []
    return [(fit, later)] if np.isfinite(fit.left_deg) else []


def sizes_that_matter() -> FloatArray:
    """Sizes below which no effect is named, in the order of `dynamics.NAMES`; zero where no effect has a place."""
    least = np.zeros(len(NAMES))
    for name, places in PLACES.items():
        least[places] = MATTERS[name]
    return least


def _matters(name: str, off: FloatArray) -> bool:
    if name not in _EITHER_WAY and off[0] <= 0.0:
        return False
    return bool(np.max(np.abs(off)) > MATTERS[name])


def _with(kept: Iterable[str]) -> BoolArray:
    """Which numbers are free where these effects are, and no other."""
    free = np.ones(len(NAMES), dtype=bool)
    for name, places in PLACES.items():
        free[places] = name in kept
    return free


def with_unknown_load(covariance: FloatArray, values: FloatArray, geometry: Geometry) -> FloatArray:
    """A covariance that admits that nobody knows how far a payload reaches.

    A load that reaches farther out slows turns more. Straight starts then speak of more mass beside the gear trains'.
    """
    mass, yaw, added = values[[10, 11, 17]]
    half_m = 0.5 * geometry.track_m
    trains = values[8] / geometry.left_wheel_radius_m**2 + values[9] / geometry.right_wheel_radius_m**2
    slower = LOAD_GYRATION * yaw * added / mass / (yaw + half_m**2 * trains)
    found = covariance.copy()
    found[17, 17] += (slower * (mass + added + trains)) ** 2
    return found


def found_powered(
    effect: RobotEffect, values: FloatArray, covariance: FloatArray, clusters: int
) -> FoundEffect:
    """An effect with its parameters, as the numbers of `dynamics.NAMES` have it; taken for certain."""
    places = PLACES[effect.key]
    if effect.id == "asymmetric_friction":
        places = [places[0] - 16, *places]  # with the friction both ways on average
    sizes, inner = values[places], covariance[np.ix_(places, places)]
    slopes = np.eye(len(places))
    values = sizes
    if effect.id == "floor_slope":
        rise = float(np.hypot(*sizes))
        values = np.degrees([np.arcsin(min(rise, 1.0)), np.arctan2(sizes[1], sizes[0])])
        along, across = sizes / rise, np.array([-sizes[1], sizes[0]]) / rise**2
        slopes = np.degrees(np.array([along, across]))
    if effect.id == "asymmetric_friction":
        middle, uneven = sizes
        values = np.array([middle + uneven, middle - uneven])
        slopes = np.array([[middle, 1.0], [middle, -1.0]])
    stds = np.sqrt(np.maximum(np.diag(slopes @ inner @ slopes.T), 0.0))
    reach = float(stdtrit(max(clusters - 1, 2), 0.975))
    params = {
        name: Estimate(
            float(value), float(std), unit, (float(value - reach * std), float(value + reach * std))
        )
        for (name, unit), value, std in zip(effect.units.items(), values, stds, strict=True)
    }
    return FoundEffect(effect.id, effect.name, effect.equation, params, 1.0, (), effect.motor)


def _notes(
    held: Sequence[Recording],
    drive: DifferentialDrive,
    geometry: Geometry,
    values: FloatArray,
    delay_s: float,
) -> tuple[str, ...]:
    said = [
        "Motors' resistances and inertias rest on the given numbers as anchors: powers and angles fix their ratios."
    ]
    if delay_s:
        said.append(
            f"The powers act {1e3 * delay_s:.0f} ms after their stamps. The fit of motors and body takes this in."
        )
    if held:
        robot = powered_robot(drive)
        stack = powered_stack(held, drive, geometry, robot)
        late = stack.delayed(delay_s) if delay_s else stack
        before, after = rms_of(stack, robot.values), rms_of(late, values)
        said.append(
            f"From the powers alone the wheels' angles err by {after:.2g}° in windows of 3 s that were not fitted; "
            f"as given by {before:.2g}°."
        )
    return tuple(said)
