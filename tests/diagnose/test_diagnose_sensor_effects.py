"""Concealed effects of sensors, made by mechanisms that the likelihoods do not know, are named and measured."""

import pytest
from diagnose_sensor_cases import sensor_diagnosis

EVERY = {"ultrasonic_sensor": 2, "light_sensor": 4, "touch_sensor": 1}
FEWER = {"ultrasonic_sensor": 4, "light_sensor": 6, "touch_sensor": 1}
"""One reading of so many is kept."""

CONCEALED = (
    ("ultrasonic_sensor", "ultrasonic_blind_zone", {"blind_distance_mm": 6.0}),
    ("ultrasonic_sensor", "ultrasonic_near_offset", {"offset_mm": 1.5, "below_mm": 8.0}),
    ("ultrasonic_sensor", "ultrasonic_range_noise", {"noise_per_distance": 0.004}),
    ("ultrasonic_sensor", "ultrasonic_dropout", {"max_angle_deg": 4.0, "best_distance_mm": 150.0}),
    ("ultrasonic_sensor", "ultrasonic_sound_speed", {"air_temperature_c": 1.0}),
    ("light_sensor", "light_ambient_offset", {"offset_raw": 1.5}),
    ("light_sensor", "light_saturation", {"knee_raw": 12.0}),
    ("light_sensor", "light_flicker", {"frequency_hz": 0.05, "amplitude_raw": 1.0}),
    ("touch_sensor", "touch_hysteresis", {"press_force_g": 0.4, "release_force_g": 0.4}),
)


SLOW = {"ultrasonic_blind_zone", "ultrasonic_near_offset", "ultrasonic_dropout"}
"""These take three to eight seconds each."""


@pytest.mark.slow_variants
@pytest.mark.parametrize(
    ("kind", "effect", "near"),
    [
        pytest.param(*each, id=each[1], marks=pytest.mark.slow if each[1] in SLOW else ())
        for each in CONCEALED
    ],
)
def test_an_effect_is_named_and_measured(kind, effect, near):
    answer, truth = sensor_diagnosis(kind, (effect,), every=EVERY[kind])
    said = answer.diagnosis
    assert said.verdict == "explained"
    assert [found.id for found in said.effects] == [effect]
    for name, within in near.items():
        estimate = said.effects[0].params[name]
        assert estimate.value == pytest.approx(truth[effect][name], abs=within)
        assert estimate.std > 0
    assert said.effects[0].probability > 0.99
    assert said.mismatch.equation == "measurement"
    assert said.mismatch.regimes[0].p_value < 1e-6


@pytest.mark.parametrize("kind", EVERY)
@pytest.mark.parametrize("seed", [11, pytest.param(12, marks=pytest.mark.slow)])
def test_nothing_is_found_where_nothing_is_missing(kind, seed):
    said = sensor_diagnosis(kind, (), seed=seed, every=EVERY[kind])[0].diagnosis
    assert said.verdict == "adequate"
    assert said.effects == ()
    assert said.mismatch.equation is None
    assert said.fit.improved == pytest.approx(said.fit.floor, rel=0.6 if kind == "touch_sensor" else 0.2)


@pytest.mark.parametrize(
    ("kind", "surprise"),
    [
        pytest.param("ultrasonic_sensor", "unknown_bent_scale", marks=pytest.mark.slow),
        ("ultrasonic_sensor", "unknown_drift"),
        ("light_sensor", "unknown_wavy_gradient"),
        ("touch_sensor", "unknown_creep"),
    ],
)
def test_what_no_library_holds_stays_unexplained(kind, surprise):
    said = sensor_diagnosis(kind, (surprise,), every=FEWER[kind])[0].diagnosis
    assert said.verdict == "unexplained"
    assert said.next_experiment is not None


@pytest.mark.slow
def test_two_effects_at_once():
    effects = ("light_ambient_offset", "light_saturation")
    answer, truth = sensor_diagnosis("light_sensor", effects, every=FEWER["light_sensor"])
    found = {effect.id: effect for effect in answer.diagnosis.effects}
    assert answer.diagnosis.verdict == "explained"
    assert set(found) == set(effects)
    offset = found["light_ambient_offset"].params["offset_raw"].value
    assert offset == pytest.approx(truth["light_ambient_offset"]["offset_raw"], abs=1.5)
