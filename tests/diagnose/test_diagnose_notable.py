"""Notable sizes: an effect below the size that motors of one make differ by has no name."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from nxt_twin.blind.case import NOMINAL
from nxt_twin.diagnose.search.notable import (
    is_hardly_too_small,
    is_notable,
    is_told_from_jitter,
    is_too_small,
)
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.parameter import NXT_SCALE, Scale
from nxt_twin.physics.plant import plant_from_config

PLAIN = plant_from_config({"kind": "dc_motor", **NOMINAL}, "power_pct")
WITH_A_SIZE = [effect for effect in PLAIN.layout.effects if effect.notable > 0.0]
SMALLER_IS_MORE = [effect for effect in PLAIN.layout.effects if math.isfinite(effect.notable_most)]
STEP = 0.02


def sized(effect: Effect, size: float):
    """The motor with `effect`, of which `size` (in its unit, at NXT scale) is the effect's own."""
    main = effect.parameters[0]
    values = {p.symbol: p.starts[0] * p.si for p in effect.parameters}
    nothing = PLAIN.values[Slot(*main.above)] if main.above else 0.0
    values[main.symbol] = nothing + size * main.si
    if "payload_inertia" in values:
        values["payload_inertia"] = values[main.symbol] / 9.81 * 0.3  # on a lever of 0.3 m
    if effect.supersedes:
        other = effect.parameters[1]
        values[other.symbol] = size * other.si
        values[main.symbol] = 3.0 * size * main.si
    return PLAIN.with_effect(effect.id, values)


@pytest.mark.parametrize("effect", WITH_A_SIZE, ids=lambda effect: effect.id)
def test_an_effect_has_a_name_from_its_notable_size_on(effect):
    main = effect.parameters[0]
    # What lies at the edge of the bounds, or hardly above the plain friction, makes no difference at any size.
    edge = max(effect.notable, 1.3 * main.lower / (1.0 - STEP))
    if main.above:
        edge = max(edge, 0.1 * PLAIN.values[Slot(*main.above)] / main.si / (1.0 - STEP))
    assert not is_notable(sized(effect, (1.0 - STEP) * effect.notable), effect, NXT_SCALE)
    assert is_notable(sized(effect, (1.0 + 2.0 * STEP) * edge), effect, NXT_SCALE)


@pytest.mark.parametrize("effect", SMALLER_IS_MORE, ids=lambda effect: effect.id)
def test_an_effect_that_does_less_the_larger_it_is_has_a_name_up_to_a_size(effect):
    assert is_notable(sized(effect, (1.0 - STEP) * effect.notable_most), effect, NXT_SCALE)
    assert not is_notable(sized(effect, (1.0 + STEP) * effect.notable_most), effect, NXT_SCALE)


def test_a_stronger_plant_has_larger_notable_sizes():
    load = PLAIN.layout.effect("constant_load")
    plant = sized(load, 1.5 * load.notable)
    assert is_notable(plant, load, NXT_SCALE)
    assert not is_notable(plant, load, Scale(torque=2.0 * NXT_SCALE.torque, speed=NXT_SCALE.speed))


@pytest.mark.parametrize(("share", "hardly"), [(0.51, True), (0.49, False)])
def test_an_effect_of_half_its_notable_size_is_hardly_too_small(share, hardly):
    drag = PLAIN.layout.effect("quadratic_drag")
    assert is_hardly_too_small(sized(drag, share * drag.notable), drag, NXT_SCALE) is hardly


def test_a_load_has_a_name_in_either_direction():
    load = PLAIN.layout.effect("constant_load")
    assert is_notable(sized(load, -1.1 * load.notable), load, NXT_SCALE)
    assert not is_notable(sized(load, -0.9 * load.notable), load, NXT_SCALE)


@pytest.mark.parametrize(
    ("turned_rad", "rest_rad", "named"),
    [(9.0, 0.0, False), (24.0, 0.0, False), (26.0, 0.0, True), (14.0, -12.0, True)],
)
def test_a_weak_spring_that_is_wound_far_has_a_name(turned_rad, rest_rad, named):
    spring = PLAIN.layout.effect("spring_load")
    plant = PLAIN.with_effect(spring.id, {"stiffness": 0.4 * spring.notable, "rest": rest_rad})
    run = SimpleNamespace(measured=np.array([0.0, np.nan, turned_rad]), is_speed=False)
    assert is_notable(plant, spring, replace(NXT_SCALE, recordings=(run,))) is named


@pytest.mark.parametrize(
    ("lever_m", "hung_at_s", "taken_off_s", "named"),
    [
        (0.0049, 5.0, 1e6, False),
        (0.0051, 5.0, 1e6, True),
        (1.99, 5.0, 1e6, True),
        (2.01, 5.0, 1e6, False),
        (0.3, 0.51, 1e6, True),
        (0.3, 0.49, 1e6, False),
        (0.3, 0.49, 9.0, True),
    ],
)
def test_a_payload_on_no_lever_or_from_the_first_reading_to_the_last_is_an_arm_or_a_disc(
    lever_m, hung_at_s, taken_off_s, named
):
    payload = PLAIN.layout.effect("hanging_payload")
    values = {p.symbol: p.starts[0] * p.si for p in payload.parameters}
    values |= {"hung_at": hung_at_s, "taken_off_at": taken_off_s}
    values["payload_inertia"] = values["payload_gravity"] / 9.81 * lever_m
    plant = PLAIN.with_effect(payload.id, values)
    assert is_notable(plant, payload, NXT_SCALE) is named
    assert not is_too_small(plant, payload, NXT_SCALE)


@pytest.mark.parametrize(
    ("pace", "of_commands", "named"), [(5.9e-3, 1.0, False), (6.1e-3, 1.0, True), (5.9e-3, 0.0, True)]
)
@pytest.mark.parametrize(("rise", "straightness"), [(0.5, 1.0), (0.04, 1.0), (0.3, 0.0)])
def test_a_clock_of_rows_and_commands_that_wanders_slowly_is_none(
    pace, of_commands, named, rise, straightness
):
    clock = PLAIN.layout.effect("clock_skew")
    values = {p.symbol: p.starts[0] * p.si for p in clock.parameters}
    steepest = (1.0 if straightness else 0.5 * np.pi) / rise
    values |= {"lag_rise": rise, "lag_straightness": straightness, "of_commands": of_commands}
    values |= {"lag_span": 0.03, "lag_period": 0.03 * steepest / pace}
    plant = PLAIN.with_effect(clock.id, values)
    assert is_notable(plant, clock, NXT_SCALE) is named
    assert not is_too_small(plant, clock, NXT_SCALE)


@pytest.mark.parametrize(("jitter_s", "told"), [(2.9e-3, True), (3.1e-3, False)])
def test_readings_held_for_less_than_three_times_the_jitter_of_polls_are_jitter(jitter_s, told):
    deviation = np.random.default_rng(1).normal(size=4001)
    deviation -= np.median(deviation)
    deviation /= 1.4826 * np.median(np.abs(deviation))
    stamps_s = np.cumsum(0.05 + jitter_s * deviation)
    polls = SimpleNamespace(time_s=stamps_s, measured=np.zeros(stamps_s.size), interval_s=5e-3)
    hold = PLAIN.layout.effect("sample_hold")
    held = PLAIN.with_effect(hold.id, {hold.parameters[0].symbol: 9e-3})
    assert is_told_from_jitter(held, hold, [polls]) is told
    assert is_told_from_jitter(PLAIN, PLAIN.layout.effect("cogging"), [polls])


@pytest.mark.parametrize(("poll_s", "told"), [(8.9e-3, True), (9.1e-3, False)])
def test_readings_held_for_less_than_a_poll_are_jitter(poll_s, told):
    stamps_s = poll_s * np.arange(101)
    polls = SimpleNamespace(time_s=stamps_s, measured=np.zeros(stamps_s.size), interval_s=poll_s)
    hold = PLAIN.layout.effect("sample_hold")
    held = PLAIN.with_effect(hold.id, {hold.parameters[0].symbol: 9e-3})
    assert is_told_from_jitter(held, hold, [polls]) is told
    slow = SimpleNamespace(time_s=5.0 * stamps_s, measured=polls.measured, interval_s=5.0 * poll_s)
    assert is_told_from_jitter(held, hold, [slow, polls]) is told


@pytest.mark.parametrize(
    "effect",
    [one for one in WITH_A_SIZE if not {"outlier", "scatter"} & {*one.terms}],
    ids=lambda effect: effect.id,
)
def test_an_effect_below_its_notable_size_lacks_nothing_but_size(effect):
    assert is_too_small(sized(effect, (1.0 - STEP) * effect.notable), effect, NXT_SCALE)
    edge = max(effect.notable, 1.3 * effect.parameters[0].lower / (1.0 - STEP))
    assert not is_too_small(sized(effect, (1.0 + 2.0 * STEP) * edge), effect, NXT_SCALE)


def test_readings_that_are_doubted_are_not_merely_too_few_for_a_name():
    stale = PLAIN.layout.effect("stale_samples")
    assert not is_too_small(sized(stale, 1e-3), stale, NXT_SCALE)


def test_a_second_body_that_is_too_light_is_not_merely_too_small():
    twist = PLAIN.layout.effect("shaft_compliance")
    values = {p.symbol: p.starts[0] * p.si for p in twist.parameters}
    light = PLAIN.with_effect(twist.id, {**values, "load_inertia": 1e-6})
    assert not is_too_small(light, twist, NXT_SCALE)
