"""Two motors coupled by a body, against closed forms."""

import numpy as np
import pytest

from nxt_twin.errors import PlantError
from nxt_twin.physics.robot.drive import drive_from_config
from nxt_twin.physics.robot.dynamics import GRAVITY, LOAD_GYRATION, wheel_angles
from nxt_twin.physics.robot.powered import dynamics_config, powered_robot

BACK_EMF, RESISTANCE, ROTOR, MASS, YAW = 0.49, 7.6, 1.2e-3, 1.0, 0.005
RADIUS, TRACK = 0.028, 0.12
SHAPE = np.array([RADIUS, RADIUS, TRACK, 0.09])
TIME_S = np.arange(0.0, 1.5, 0.02)


def driven(volts, heading_rad=0.0, **changes):
    """Angles of a robot without friction, from rest."""
    names = {"drag_force": 12, "slope_ahead": 13, "added_mass": 17}
    values = np.array([BACK_EMF] * 2 + [RESISTANCE] * 2 + [1e-9] * 4 + [ROTOR] * 2 + [MASS, YAW] + [0.0] * 6)
    for name, value in changes.items():
        values[names[name]] = value
    begins = TIME_S == 0.0
    both, heading = np.tile(volts, (TIME_S.size, 1)), np.full(TIME_S.size, heading_rad)
    return wheel_angles(values, SHAPE, TIME_S, both, heading, begins, np.zeros((TIME_S.size, 2)))


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


def plant(**changes):
    motor = {
        "resistance_ohm": RESISTANCE,
        "back_emf_v_s_per_rad": BACK_EMF,
        "coulomb_friction_nm": 8e-3,
        "viscous_friction_nm_s_per_rad": 2e-3,
        "inertia_kg_m2": ROTOR,
    }
    return {
        "kind": "differential_drive",
        "left": "b",
        "right": "c",
        "left_wheel_radius_m": RADIUS,
        "right_wheel_radius_m": RADIUS,
        "track_m": TRACK,
        "motor": motor,
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


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"mass_kg": 0.0}, "mass_kg: '0.0' is no positive number"),
        ({"motor": {}}, "back_emf_v_s_per_rad: is missing"),
    ],
)
def test_a_wrong_dynamic_key_is_named(change, says):
    with pytest.raises(PlantError, match=says):
        powered_robot(drive_from_config(plant(**change)))
