"""What every declaration of an effect has to say."""

import math

import numpy as np
import pytest
from physics_samples import commanded, nxt

from nxt_twin.physics.layout import Slot, layout
from nxt_twin.physics.library import library
from nxt_twin.physics.parameter import NXT_SCALE, Scale
from nxt_twin.physics.signals import in_session

CONTRACT = {
    "coulomb_friction": ("coulomb_friction_nm",),
    "viscous_friction": ("viscous_friction_nm_s_per_rad",),
    "inductance": ("inductance_h",),
    "presliding": ("presliding_deg",),
    "stiction": ("breakaway_torque_nm", "stribeck_speed_rad_s"),
    "asymmetric_friction": ("coulomb_forward_nm", "coulomb_reverse_nm"),
    "load_dependent_friction": ("friction_per_torque",),
    "quadratic_drag": ("quadratic_drag_nm_s2_per_rad2",),
    "friction_warmup": ("cold_extra_torque_nm", "time_constant_s"),
    "angle_dependent_friction": ("binding_torque_nm", "cycles_per_turn"),
    "backlash": ("gap_deg", "load_inertia_kg_m2"),
    "shaft_compliance": ("stiffness_nm_per_rad", "load_inertia_kg_m2"),
    "gravity_load": ("gravity_torque_nm", "phase_deg"),
    "cogging": ("cogging_torque_nm", "cycles_per_turn"),
    "payload_inertia": ("added_inertia_kg_m2",),
    "end_stop": ("limit_deg",),
    "constant_load": ("load_torque_nm",),
    "spring_load": ("stiffness_nm_per_rad", "rest_angle_deg"),
    "battery_sag": ("internal_resistance_ohm",),
    "battery_drain": ("drain_v_per_s",),
    "winding_heating": ("resistance_rise_per_joule", "thermal_time_constant_s"),
    "current_limit": ("current_limit_a",),
    "voltage_drop": ("drop_v",),
    "power_curve": ("exponent",),
    "command_delay": ("delay_s",),
    "clock_skew": ("rate_error", "lag_span_s"),
    "stale_samples": ("stale_fraction",),
    "missed_counts": ("loss_fraction", "speed_threshold_rad_s"),
    "sample_hold": ("refresh_period_s",),
    "hanging_payload": ("gravity_torque_nm", "added_inertia_kg_m2", "phase_deg"),
    "torque_saturation": ("torque_yield_per_a",),
    "commutation_ripple": ("ripple_fraction", "cycles_per_turn"),
    "encoder_eccentricity": ("amplitude_deg", "cycles_per_turn"),
}
OF_A_LOOP = {"power_limit": ("limit_pct",), "loop_dead_band": ("width_deg",)}
"""Those of a servo alone."""
EFFECTS = list(library().values())


def test_the_library_has_every_promised_effect_under_its_names():
    for effect_id, names in {**CONTRACT, **OF_A_LOOP}.items():
        declared = {parameter.name for parameter in library()[effect_id].parameters}
        assert set(names) <= declared, effect_id


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.id)
def test_the_name_in_words_holds_the_id(effect):
    """The terminal, the report and a plant file call an effect alike."""
    assert effect.id.replace("_", "") in "".join(c for c in effect.name.lower() if c.isalnum())


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.id)
def test_a_declaration_is_whole(effect):
    assert effect.name
    assert effect.equation
    assert effect.source
    assert effect.shows
    assert effect.terms
    assert effect.confusable_with
    assert set(effect.moving) | set(effect.lasting) <= set(effect.states)
    assert (not effect.states) == ("advance" not in effect.terms)
    for parameter in effect.parameters:
        assert parameter.unit
        assert parameter.starts
        assert all(parameter.lower <= start <= parameter.upper for start in parameter.starts)
        assert math.isfinite(parameter.lower)
        assert math.isfinite(parameter.upper)


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.id)
def test_a_confusion_is_declared_with_an_effect_that_is_there_and_from_both_sides(effect):
    for other_id, why in effect.confusable_with.items():
        assert effect.id in library()[other_id].confusable_with
        assert why


@pytest.mark.parametrize(
    ("kind", "frame"), [("dc_motor", "motor"), ("rigid_body", "rotary"), ("rigid_body", "linear")]
)
def test_names_of_a_frame_are_unique_within_an_effect(kind, frame):
    plan = layout(kind, frame)
    for effect in plan.effects:
        names = [p.in_frame(frame).name for p in effect.parameters]
        assert len(set(names)) == len(names)


def test_an_end_stop_is_sought_where_the_readings_end():
    run = commanded([(0.0, 0.5)], seconds=1.0)
    run.measured[:] = np.linspace(-0.5, 7.0, run.measured.size)
    limit = library()["end_stop"].parameters[0]
    assert limit.scaled(NXT_SCALE).starts == limit.starts
    found = limit.scaled(Scale(0.3, 10.0, (run,)))
    assert found.starts == pytest.approx((math.degrees(7.0), math.degrees(-0.5)))


@pytest.mark.parametrize(
    ("effect", "name", "factor"),
    [
        ("current_limit", "current_limit_a", 10.0),
        ("voltage_drop", "drop_v", 3.0),
        ("battery_drain", "drain_v_per_s", 3.0),
        ("battery_sag", "internal_resistance_ohm", 0.3),
        ("winding_heating", "resistance_rise_per_joule", 1.0 / 30.0),
        ("torque_saturation", "torque_yield_per_a", 0.1),
    ],
)
def test_an_electrical_size_is_sought_where_a_stronger_motor_has_it(effect, name, factor):
    at = library()[effect].parameters[0]
    assert at.name == name
    # three times the voltage at ten times the current: thirty times the power
    strong = Scale(torque=30.0 * NXT_SCALE.torque, speed=NXT_SCALE.speed, current=10.0 * NXT_SCALE.current)
    found = at.scaled(strong)
    assert found.starts == pytest.approx([factor * start for start in at.starts])
    assert found.upper == pytest.approx(factor * at.upper)


def test_a_command_is_sought_as_early_as_one_poll_before_its_row():
    run = commanded([(0.0, 0.5)], seconds=1.0, every_s=0.02)
    run.measured[:] = 0.0
    found = library()["command_delay"].parameters[0].scaled(Scale(0.3, 10.0, (run,)))
    assert found.lower == pytest.approx(-0.02)
    assert found.starts == pytest.approx((0.01, 0.04, 0.1, -0.01, -0.02))


def test_a_hanging_payload_is_sought_where_later_recordings_begin_or_within_a_single_one():
    runs = in_session([commanded([(0.0, 0.5)], seconds=4.0)] * 3)
    onset = library()["hanging_payload"].parameters[3]
    assert onset.scaled(Scale(0.3, 10.0, tuple(runs))).starts == pytest.approx((4.0, 8.0))
    assert onset.scaled(Scale(0.3, 10.0, (runs[0],))).starts == pytest.approx((1.0, 2.0, 3.0))


def test_a_payload_is_sought_at_every_recording_and_within_each():
    runs = in_session([commanded([(0.0, 0.5)], seconds=4.0)] * 2)
    onset = library()["payload_inertia"].parameters[1]
    assert onset.scaled(Scale(0.3, 10.0, tuple(runs))).starts == pytest.approx(
        (0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 4.5, 5.0, 5.5, 6.0, 6.5, 7.0)
    )


@pytest.mark.parametrize("effect_id", [effect_id for effect_id in CONTRACT if not library()[effect_id].plain])
def test_a_plant_file_needs_no_more_than_the_promised_names(effect_id):
    parameters = {p.name: p for p in library()[effect_id].parameters}
    given = {name: parameters[name].starts[0] for name in CONTRACT[effect_id]}
    plant = nxt(effects={effect_id: given})
    for name, parameter in parameters.items():
        assert plant.values[Slot(effect_id, parameter.symbol)] == pytest.approx(
            given.get(name, parameter.otherwise) * parameter.si
        )
