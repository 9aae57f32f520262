"""Plant files: what is read, what is refused and how, and what is written back."""

import math
import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from physics_samples import NXT

from nxt_twin.errors import PlantError
from nxt_twin.physics.layout import Slot, layout
from nxt_twin.physics.plant import frame_for, plant_from_config

RIGID = {"kind": "rigid_body", "inertia": 95.0}
FRAMES = [
    ("dc_motor", "motor", "power_pct", {**NXT}),
    ("rigid_body", "rotary", "torque_nm", RIGID),
    ("rigid_body", "linear", "force_n", RIGID),
]
NESTED = [
    pytest.param(kind, frame, given_kind, base, effect, id=f"{frame}-{effect.id}")
    for kind, frame, given_kind, base in FRAMES
    for effect in layout(kind, frame).effects
    if not effect.plain
]


def refusal(config, kind="power_pct"):
    with pytest.raises(PlantError) as caught:
        plant_from_config(config, kind)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def without(*keys):
    return {key: value for key, value in NXT.items() if key not in keys}


def test_a_plant_reads_its_keys_in_si():
    plant = plant_from_config(NXT, "power_pct")
    assert plant.values[Slot("base", "resistance")] == 7.6
    assert plant.values[Slot("coulomb_friction", "coulomb")] == 8.45e-3
    assert plant.active == {"coulomb_friction", "viscous_friction", "inductance"}


def test_a_key_left_out_is_physics_left_out():
    plant = plant_from_config(without("coulomb_friction_nm", "inductance_h"), "power_pct")
    assert plant.active == {"viscous_friction"}
    assert "coulomb_friction_nm" not in plant.to_config()


def test_a_motor_without_a_supply_takes_8_volts():
    assert plant_from_config(without("supply_v"), "power_pct").values[Slot("base", "supply_v")] == 8.0


@pytest.mark.parametrize(
    "key", ["resistance_ohm", "torque_constant_nm_per_a", "back_emf_v_s_per_rad", "inertia_kg_m2"]
)
def test_a_missing_key_is_named_with_its_unit(key):
    line = refusal(without(key))
    assert key in line
    assert "missing" in line


def test_an_unknown_key_is_refused_with_the_nearest_known_one():
    line = refusal({**without("viscous_friction_nm_s_per_rad"), "viscous_friction_nms_per_rad": 2e-3})
    assert "viscous_friction_nms_per_rad" in line
    assert "did you mean 'viscous_friction_nm_s_per_rad'" in line


def test_an_unlikely_key_is_refused_with_all_known_ones():
    line = refusal({**NXT, "colour": 1.0})
    assert "colour" in line
    assert "resistance_ohm" in line


@pytest.mark.parametrize("kind", ["stepper_motor", 3, None])
def test_a_wrong_or_missing_kind_is_refused_with_the_kinds_there_are(kind):
    line = refusal({**NXT, "kind": kind})
    assert "dc_motor" in line
    assert "rigid_body" in line


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, "fast", True, None, [1.0]])
def test_what_is_no_finite_number_is_refused_by_name(value):
    assert "inertia_kg_m2" in refusal({**NXT, "inertia_kg_m2": value})


@pytest.mark.parametrize("key", ["inertia_kg_m2", "coulomb_friction_nm", "supply_v"])
def test_a_negative_value_is_refused_where_physics_has_none(key):
    line = refusal({**NXT, key: -1e-3})
    assert key in line
    assert "negative" in line


def test_a_load_may_be_negative():
    plant = plant_from_config({**NXT, "effects": {"constant_load": {"load_torque_nm": -0.02}}}, "power_pct")
    assert plant.values[Slot("constant_load", "load")] == -0.02


def test_an_unknown_effect_is_refused_with_those_there_are():
    line = refusal({**NXT, "effects": {"stikcion": {}}})
    assert "stikcion" in line
    assert "stiction" in line


@pytest.mark.parametrize("effects", [["stiction"], "stiction"])
def test_effects_that_are_no_mapping_are_refused(effects):
    assert "effects" in refusal({**NXT, "effects": effects})


@pytest.mark.parametrize("inside", [None, 3.0, {"breakaway_torque_nm": 0.1}, {"breakaway": 0.1}])
def test_an_effect_with_missing_or_unknown_parameters_is_refused_where_it_stands(inside):
    line = refusal({**NXT, "effects": {"stiction": inside}})
    assert "effects, stiction" in line


def test_a_plain_effect_is_given_by_the_plant_s_own_key_and_not_nested():
    line = refusal(
        {**without("coulomb_friction_nm"), "effects": {"coulomb_friction": {"coulomb_friction_nm": 0.01}}}
    )
    assert "coulomb_friction" in line


@pytest.mark.parametrize(
    ("kind", "input_kind", "frame"),
    [
        ("dc_motor", "power_pct", "motor"),
        ("dc_motor", "voltage_v", "motor"),
        ("dc_motor", "current_a", "motor"),
        ("rigid_body", "torque_nm", "rotary"),
        ("rigid_body", "force_n", "linear"),
    ],
)
def test_the_input_s_kind_says_in_which_frame_a_plant_stands(kind, input_kind, frame):
    assert frame_for(kind, input_kind) == frame


@pytest.mark.parametrize(("kind", "input_kind"), [("dc_motor", "force_n"), ("rigid_body", "power_pct")])
def test_a_plant_that_its_input_cannot_drive_is_refused(kind, input_kind):
    assert kind in refusal({"kind": kind, "inertia": 1.0}, input_kind)


def test_a_linear_plant_carries_linear_names_and_no_effects_of_rotation():
    plan = layout("rigid_body", "linear")
    names = {parameter.name for parameter in plan.parameters.values()}
    assert {"load_force_n", "coulomb_forward_n", "coulomb_reverse_n", "load_mass_kg", "gap_mm"} <= names
    assert not [name for name in names if re.search(r"_nm(_|$)|_rad|_deg|torque|angle", name)]
    assert not {"gravity_load", "battery_sag"} & {effect.id for effect in plan.effects}


def test_a_linear_plant_refuses_the_rotary_name_and_says_its_own():
    line = refusal({**RIGID, "effects": {"constant_load": {"load_torque_nm": 1.0}}}, "force_n")
    assert "load_force_n" in line


@pytest.mark.parametrize(
    ("effect_id", "given_values", "symbol", "si"),
    [
        ("backlash", {"gap_mm": 5.0, "load_mass_kg": 1.0}, "gap", 5e-3),
        ("spring_load", {"stiffness_n_per_m": 10.0, "rest_position_m": 0.25}, "rest", 0.25),
        ("constant_load", {"load_force_n": -3.0}, "load", -3.0),
    ],
)
def test_a_linear_plant_s_lengths_are_what_their_names_say(effect_id, given_values, symbol, si):
    plant = plant_from_config({**RIGID, "effects": {effect_id: given_values}}, "force_n")
    assert plant.values[Slot(effect_id, symbol)] == pytest.approx(si)


@pytest.mark.parametrize(("kind", "frame", "input_kind", "base", "effect"), NESTED)
def test_a_plant_with_any_effect_reads_back_as_it_was_written(kind, frame, input_kind, base, effect):
    parameters = [parameter.in_frame(frame) for parameter in effect.parameters]
    inside = {parameter.name: 1.1 * parameter.starts[0] for parameter in parameters}
    config = {**base, "effects": {effect.id: inside}}
    written = plant_from_config(config, input_kind).to_config()
    assert written["kind"] == kind
    told = {p.name: inside[p.name] for p in parameters if not p.is_idle(inside[p.name] * p.si)}
    assert written["effects"][effect.id] == pytest.approx(told, rel=1e-7)
    replaced = {
        p.in_frame(frame).name
        for gone in effect.supersedes
        for p in layout(kind, frame).effect(gone).parameters
    }
    kept = {key: value for key, value in base.items() if key not in replaced}
    assert {key: value for key, value in written.items() if key != "effects"} == kept


@settings(deadline=None)
@given(data=st.data(), frame=st.sampled_from(FRAMES))
def test_any_plant_survives_being_written_and_read(data, frame):
    kind, name, input_kind, base = frame
    nested = [effect for effect in layout(kind, name).effects if not effect.plain]
    chosen = data.draw(st.lists(st.sampled_from(nested), unique_by=lambda effect: effect.id, max_size=5))
    effects = {}
    for effect in chosen:
        parameters = [parameter.in_frame(name) for parameter in effect.parameters]
        effects[effect.id] = {p.name: data.draw(st.floats(p.lower, p.upper)) for p in parameters}
    plant = plant_from_config({**base, "effects": effects}, input_kind)
    again = plant_from_config(plant.to_config(), input_kind)
    assert again.active == plant.active
    assert dict(again.values) == pytest.approx(dict(plant.values), rel=1e-7, abs=1e-300)


def test_an_effect_takes_the_place_of_what_it_supersedes():
    plant = plant_from_config(NXT, "power_pct").with_effect(
        "asymmetric_friction", {"forward": 0.02, "reverse": 0.01}
    )
    assert "coulomb_friction" not in plant.active
    assert "coulomb_friction_nm" not in plant.to_config()
    assert plant.to_config()["effects"] == {
        "asymmetric_friction": {"coulomb_forward_nm": 0.02, "coulomb_reverse_nm": 0.01}
    }


def test_an_effect_taken_out_leaves_nothing_of_it_behind():
    plain = plant_from_config(NXT, "power_pct")
    added = plain.with_effect("stiction", {"breakaway": 0.05, "stribeck_speed": 1.0})
    assert added.to_config() != plain.to_config()
    assert added.without(["stiction"]).to_config() == plain.to_config()


def test_a_plant_is_not_changed_by_making_another_from_it():
    plain = plant_from_config(NXT, "power_pct")
    before = plain.to_config()
    heavier = plain.with_values({Slot("base", "inertia"): 2e-3})
    assert heavier.to_config()["inertia_kg_m2"] == 2e-3
    assert plain.to_config() == before


@pytest.mark.parametrize(
    "key", ["inertia_kg_m2", "resistance_ohm", "torque_constant_nm_per_a", "back_emf_v_s_per_rad"]
)
def test_a_number_that_motion_divides_by_is_not_zero(key):
    assert f"{key}: is zero" in refusal({**NXT, key: 0})
