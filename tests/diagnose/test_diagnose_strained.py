"""Found effects that stand for one law which none of them is."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest
from diagnose_records import FOUND, QUIET

from nxt_twin.blind.case import NOMINAL
from nxt_twin.diagnose.judging.strained import is_one_sided, is_stretched
from nxt_twin.diagnose.judging.verdict import is_another_law, verdict_of
from nxt_twin.physics.parameter import NXT_SCALE
from nxt_twin.physics.plant import plant_from_config

PLAIN = plant_from_config({"kind": "dc_motor", **NOMINAL}, "power_pct")
PROBLEM = SimpleNamespace(scale=NXT_SCALE)


def found(*effects):
    """A plant with effects and their parameters, SI, and the effects."""
    plant = PLAIN
    for effect_id, values in effects:
        effect = plant.layout.effect(effect_id)
        starts = {p.symbol: p.starts[0] * p.si for p in effect.parameters}
        plant = plant.with_effect(effect_id, starts | values)
    return plant, [plant.layout.effect(effect_id) for effect_id, _ in effects]


@pytest.mark.parametrize(("sharpness", "stretched"), [(39.99, False), (40.0, True), (0.5, False)])
def test_a_shape_on_its_upper_bound_is_stretched(sharpness, stretched):
    assert is_stretched(PROBLEM, *found(("angle_dependent_friction", {"sharpness": sharpness}))) is stretched


def test_a_phase_on_its_bound_is_not():
    assert not is_stretched(PROBLEM, *found(("angle_dependent_friction", {"phase": 2.0 * math.pi})))


@pytest.mark.parametrize(
    ("bound", "stretched"),
    [
        ({"lag_phase": 1.0}, False),
        ({"lag_mean": 0.7}, False),
        ({"of_commands": 1.0}, False),
        ({"lag_straightness": 1.0}, False),
        ({"lag_rise": 0.98}, False),
        ({"second_share": 0.8}, False),
        ({"lag_span": 0.5}, True),
    ],
)
def test_of_a_lag_that_wanders_only_its_size_may_be_stretched(bound, stretched):
    assert is_stretched(PROBLEM, *found(("clock_skew", bound))) is stretched


def test_the_usual_law_on_a_bound_is_not():
    """Most who draw Stribeck's curve take the exponent 2, which is the largest."""
    assert not is_stretched(PROBLEM, *found(("stiction", {"stribeck_exponent": 2.0})))


@pytest.mark.parametrize(("times", "stretched"), [(1.29, True), (1.31, False), (20.0, False)])
def test_friction_that_is_larger_at_rest_alone_is_no_curve_of_stribeck(times, stretched):
    speed = next(p for p in PLAIN.layout.effect("stiction").parameters if p.symbol == "stribeck_speed")
    assert is_stretched(PROBLEM, *found(("stiction", {"stribeck_speed": times * speed.lower}))) is stretched


@pytest.mark.parametrize(
    ("cycles", "phase", "one_sided"),
    [
        (3.0, 1.0, True),
        (3.0, 1.0 + math.pi, True),
        (3.0, 1.0 - 3.0 * math.pi, True),
        (3.0, 1.149, True),
        (3.0, 1.151, False),
        (3.0, 0.851, True),
        (3.0, 0.849, False),
        (3.059, 1.0, True),
        (3.061, 1.0, False),
    ],
)
def test_a_torque_and_a_friction_of_the_same_cycles_in_phase_act_one_way(cycles, phase, one_sided):
    plant, effects = found(
        ("cogging", {"cycles": cycles, "phase": phase}),
        ("angle_dependent_friction", {"cycles": 3.0, "phase": 1.0}),
    )
    assert is_one_sided(plant, effects) is one_sided


def test_one_of_them_alone_or_beside_an_encoder_off_its_centre_acts_both_ways():
    angle = {"cycles": 1.0, "phase": 0.5}
    assert not is_one_sided(*found(("cogging", angle)))
    assert not is_one_sided(*found(("angle_dependent_friction", angle), ("encoder_eccentricity", angle)))


def test_strained_effects_are_another_law_however_small_the_error_is():
    near = replace(FOUND, matters=False, remaining=0.1)
    assert verdict_of(near) == "explained"
    assert verdict_of(replace(near, strained=True)) == "unexplained"
    assert not is_another_law(replace(QUIET, strained=True))
