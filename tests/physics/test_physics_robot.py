"""Two motors coupled by a body, against closed forms."""

import numpy as np
import pytest

from nxt_twin.errors import PlantError
from nxt_twin.physics.robot.drive import drive_from_config
from nxt_twin.physics.robot.dynamics import GRAVITY, LOAD_GYRATION, NAMES, dropped, wheel_angles
from nxt_twin.physics.robot.powered import body_effects, dynamics_config, powered_robot

BACK_EMF, RESISTANCE, ROTOR, MASS, YAW = 0.49, 7.6, 1.2e-3, 1.0, 0.005
RADIUS, TRACK, OPEN_V = 0.028, 0.12, 8.0
SHAPE = np.array([RADIUS, RADIUS, TRACK, 0.09, 0.0, 0.0])
TIME_S = np.arange(0.0, 1.5, 0.02)


def driven(volts, heading_rad=0.0, *, off_phase_open=False, **changes):
    """Angles of a robot without friction, from rest."""
    values = np.array([BACK_EMF] * 2 + [RESISTANCE] * 2 + [1e-9] * 4 + [ROTOR] * 2 + [MASS, YAW] + [0.0] * 14)
    for name, value in changes.items():
        values[NAMES.index(name)] = value
    begins = TIME_S == 0.0
    both, heading = np.tile(volts, (TIME_S.size, 1)), np.full(TIME_S.size, heading_rad)
    floats, open_v = np.zeros((TIME_S.size, 2)), np.full(TIME_S.size, OPEN_V)
    if off_phase_open:
        floats += 1.0
    return wheel_angles(
        values, SHAPE, TIME_S, both, heading, begins, np.zeros((TIME_S.size, 2)), open_v, floats
    )


def first_order(volts, inertia):
    """Angle of a motor that takes up speed against its own back-emf."""
    constant = inertia * RESISTANCE / BACK_EMF**2
    return volts / BACK_EMF * (TIME_S - constant * (1.0 - np.exp(-TIME_S / constant)))


@pytest.mark.parametrize("added", [0.0, 0.6])
def test_a_straight_start_carries_the_body_on_both_wheels(added):
    found = driven((6.0, 6.0), added_mass=added)
    expected = first_order(6.0, ROTOR + 0.5 * (MASS + added) * RADIUS**2)
    np.testing.assert_allclose(found[:, 0], expected, atol=2e-3 * expected[-1])
    np.testing.assert_array_equal(found[:, 0], found[:, 1])


@pytest.mark.parametrize("added", [0.0, 0.6])
def test_a_turn_on_the_spot_carries_the_yaw_inertia_and_the_loads(added):
    found = driven((-6.0, 6.0), added_mass=added)
    yaw = YAW * (1.0 + LOAD_GYRATION * added / MASS)
    expected = first_order(6.0, ROTOR + 2.0 * yaw * RADIUS**2 / TRACK**2)
    np.testing.assert_allclose(found[:, 1], expected, atol=2e-3 * expected[-1])
    np.testing.assert_allclose(found[:, 0], -found[:, 1])


def test_uphill_and_drag_take_off_the_speed_that_their_force_costs():
    for changes, force in (({"slope_ahead": 0.05}, MASS * GRAVITY * 0.05), ({"drag_force": 0.5}, 0.5)):
        rates = np.diff(driven((6.0, 6.0), **changes)[:, 0])[-1] / 0.02
        lost = 0.5 * force * RADIUS * RESISTANCE / BACK_EMF**2
        assert 6.0 / BACK_EMF - rates == pytest.approx(lost, rel=0.02)
    downhill = np.diff(driven((6.0, 6.0), np.pi, slope_ahead=0.05)[:, 0])[-1] / 0.02
    assert downhill > 6.0 / BACK_EMF


def steady(volts, **changes):
    """Speed of both wheels at the end, rad/s."""
    return np.diff(driven(volts, **changes), axis=0)[-1] / 0.02


def test_scrub_slows_turns_on_the_spot_and_no_straight_drive():
    straight, turning = steady((6.0, 6.0), scrub_torque=0.03), steady((-6.0, 6.0), scrub_torque=0.03)
    assert straight == pytest.approx([6.0 / BACK_EMF] * 2, rel=1e-3)
    lost = 0.03 / TRACK * RADIUS * RESISTANCE / BACK_EMF**2
    assert turning == pytest.approx([lost - 6.0 / BACK_EMF, 6.0 / BACK_EMF - lost], rel=0.02)


def test_a_weak_battery_feeds_both_motors_less_while_they_draw_current():
    # Drag holds a steady current: each bridge draws its motor's for three quarters of the time.
    loaded = steady((6.0, 6.0), drag_force=4.0)
    current_a = 0.5 * 4.0 * RADIUS / BACK_EMF
    sagging = steady((6.0, 6.0), drag_force=4.0, battery_resistance=2.0)
    lost_v = 0.75 * 2.0 * 2.0 * 0.75 * current_a
    assert loaded - sagging == pytest.approx([lost_v / BACK_EMF] * 2, rel=0.03)


@pytest.mark.parametrize(
    ("change", "lost_rad_s"),
    [
        ({"left_uneven": 0.02}, 0.02 * RESISTANCE / BACK_EMF**2),
        ({"left_drop": 0.5, "left_coulomb": 0.05}, (0.5 + 0.05 * RESISTANCE / BACK_EMF) / BACK_EMF),
    ],
)
def test_what_one_motor_has_slows_its_wheel_on_the_spot(change, lost_rad_s):
    # The body rolls on both wheels: on the spot each has half of the loss.
    left, right = steady((6.0, -6.0), **change)
    assert 6.0 / BACK_EMF - 0.5 * (left - right) == pytest.approx(0.5 * lost_rad_s, rel=0.03)


@pytest.mark.parametrize(
    ("across_v", "taken_v"), [(4.0, 0.6), (-4.0, -0.6), (0.2, 0.2), (-0.2, -0.2), (0.0, 0.0)]
)
def test_brushes_take_their_drop_or_all_that_there_is(across_v, taken_v):
    assert dropped(across_v, 0.6) == pytest.approx(taken_v, abs=0.02)


def test_brushes_never_drive_a_motor_that_coasts_under_a_shorted_bridge():
    # Below its drop next to no current flows: the wheels nearly keep the speed with which they start.
    still = np.zeros((TIME_S.size, 2))
    values = np.array([BACK_EMF] * 2 + [RESISTANCE] * 2 + [1e-9] * 4 + [ROTOR] * 2 + [MASS, YAW] + [0.0] * 14)
    values[[NAMES.index("left_drop"), NAMES.index("right_drop")]] = 1.0
    start = np.tile([0.5 * RADIUS / BACK_EMF, 0.0], (TIME_S.size, 1))
    angles = wheel_angles(
        values, SHAPE, TIME_S, still, still[:, 0], TIME_S == 0.0, start, np.full(TIME_S.size, OPEN_V), still
    )
    kept = 0.5 / BACK_EMF * TIME_S[-1]
    assert np.all((angles[-1] > 0.8 * kept) & (angles[-1] < kept))


def test_with_an_open_off_phase_the_whole_voltage_drives_for_the_dutys_share():
    # A quarter of the time 8 V, and no current brakes: the motor nears the speed of the whole voltage.
    shorted, open_off = steady((2.0, 2.0)), steady((2.0, 2.0), off_phase_open=True)
    assert shorted == pytest.approx([2.0 / BACK_EMF] * 2, rel=0.01)
    share = 0.25
    constant_s = (ROTOR + 0.5 * MASS * RADIUS**2) * RESISTANCE / BACK_EMF**2 / share
    expected = OPEN_V / BACK_EMF * (1.0 - np.exp(-(TIME_S[-1] - 0.01) / constant_s))
    assert open_off == pytest.approx([expected] * 2, rel=0.02)


MOTOR = {
    "resistance_ohm": RESISTANCE,
    "back_emf_v_s_per_rad": BACK_EMF,
    "coulomb_friction_nm": 8e-3,
    "viscous_friction_nm_s_per_rad": 2e-3,
    "inertia_kg_m2": ROTOR,
}


def plant(**changes):
    return {
        "kind": "differential_drive",
        "left": "b",
        "right": "c",
        "left_wheel_radius_m": RADIUS,
        "right_wheel_radius_m": RADIUS,
        "track_m": TRACK,
        "motor": MOTOR,
        "mass_kg": MASS,
        "yaw_inertia_kg_m2": YAW,
        "caster_back_m": 0.09,
        **changes,
    }


def test_dynamic_keys_come_back_as_they_were_written():
    drive = drive_from_config(plant(effects={"floor_slope": {"slope_deg": 3.0, "uphill_heading_deg": 90.0}}))
    robot = powered_robot(drive)
    assert robot.values[14] == pytest.approx(np.sin(np.radians(3.0)))
    again = drive_from_config({**plant(), **dynamics_config(drive, robot.values)})
    np.testing.assert_allclose(powered_robot(again).values[:12], robot.values[:12])


def test_effects_of_motors_and_battery_come_back_as_they_were_written():
    own = {
        "asymmetric_friction": {"coulomb_forward_nm": 0.012, "coulomb_reverse_nm": 0.006},
        "quadratic_drag": {"quadratic_drag_nm_s2_per_rad2": 1e-3},
        "voltage_drop": {"drop_v": 0.4},
    }
    effects = {"battery_sag": {"internal_resistance_ohm": 0.5}}
    drive = drive_from_config(
        plant(
            left_motor={**MOTOR, "effects": own}, effects=effects, scrub_torque_nm=0.01, centre_height_m=0.05
        )
    )
    robot = powered_robot(drive)
    by_name = dict(zip(NAMES, robot.values, strict=True))
    assert (by_name["left_coulomb"], by_name["left_uneven"]) == (pytest.approx(0.009), pytest.approx(0.003))
    assert (by_name["right_coulomb"], by_name["right_uneven"]) == (pytest.approx(8e-3), 0.0)
    assert dynamics_config(drive, robot.values)["left_motor"]["effects"] == own
    assert body_effects(robot.values) == effects
    again = drive_from_config({**plant(), **dynamics_config(drive, robot.values), "effects": effects})
    np.testing.assert_allclose(powered_robot(again).values, robot.values)
    assert powered_robot(again).height_m == 0.05


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"mass_kg": 0.0}, "mass_kg: '0.0' is no positive number"),
        ({"motor": {}}, "back_emf_v_s_per_rad: is missing"),
        ({"scrub_torque_nm": -1.0}, "scrub_torque_nm: '-1.0' is no positive number"),
        ({"left_motor": {**MOTOR, "effects": {"backlash": {}}}}, "backlash: is no effect of a robot's motor"),
        ({"left_motor": {**MOTOR, "effects": {"voltage_drop": {}}}}, "voltage_drop: needs drop_v"),
    ],
)
def test_a_wrong_dynamic_key_is_named(change, says):
    with pytest.raises(PlantError, match=says):
        powered_robot(drive_from_config(plant(**change)))
